#include "prefilter/sampling/sample.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/sampling/pyramid_sampler.h"

namespace prefilter {
namespace {

using Coordinates = std::array<double, 2>;

constexpr std::int64_t kSamplesOfRange = 1 << 12;

void check_places(std::span<const Coordinates> coordinates, std::span<const double> scales,
                  std::int64_t first) {
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    for (const double coordinate : coordinates[i]) {
      if (std::isfinite(coordinate)) continue;
      throw_invalid("coordinates: found " + to_text(coordinate) + " in row " +
                    std::to_string(first + i) + "; finite numbers are needed");
    }
  }
  for (std::size_t i = 0; i < scales.size(); ++i) {
    if (scales[i] >= 0.0 && std::isfinite(scales[i])) continue;
    throw_invalid("scales: found " + to_text(scales[i]) + " at " + std::to_string(first + i) +
                  "; finite numbers of at least 0 are needed");
  }
}

}  // namespace

void sample(const Pyramid& pyramid, const SamplingTable* table,
            std::span<const Coordinates> coordinates, std::span<const double> scales,
            const SampleOptions& options, std::span<float> result) {
  const PyramidSampler sampler(pyramid, table, options.wrap);
  if (scales.size() != coordinates.size() && scales.size() != 1) {
    throw_invalid("scales: found " + std::to_string(scales.size()) + "; " +
                  std::to_string(coordinates.size()) +
                  ", as many as coordinates, or one are needed");
  }
  const auto channels = static_cast<std::size_t>(pyramid.channels);
  if (result.size() != coordinates.size() * channels) {
    throw_invalid("result: found " + std::to_string(result.size()) + " values; " +
                  std::to_string(coordinates.size() * channels) + " are needed");
  }
  const bool is_constant = scales.size() == 1;
  if (is_constant) check_places({}, scales, 0);
  parallel_ranges(
      static_cast<std::int64_t>(coordinates.size()), kSamplesOfRange, options.threads,
      options.progress, [&](std::int64_t begin, std::int64_t end) {
        const auto count = static_cast<std::size_t>(end - begin);
        check_places(coordinates.subspan(begin, count),
                     is_constant ? std::span<const double>() : scales.subspan(begin, count), begin);
        sampler.sample(coordinates.subspan(begin, count),
                       is_constant ? scales : scales.subspan(begin, count),
                       result.data() + begin * channels);
      });
}

}  // namespace prefilter
