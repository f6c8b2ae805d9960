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
#include "prefilter/sampling/weigh_texels.h"

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

template <typename Value>
void add_texels(const Pyramid& pyramid, const WeightedTexels& found, std::vector<double>& sums) {
  const auto channels = static_cast<std::size_t>(pyramid.channels);
  for (int i = 0; i < found.count; ++i) {
    const auto& [level, x, y, weight] = found.texels[i];
    if (x < 0 || y < 0) continue;
    const PyramidLevel& texels = pyramid.levels[level];
    const Value* texel = static_cast<const Value*>(texels.texels) +
                         (static_cast<std::size_t>(y) * texels.width + x) * channels;
    for (std::size_t c = 0; c < channels; ++c) sums[c] += weight * texel[c];
  }
}

}  // namespace

void sample(const Pyramid& pyramid, const SamplingTable* table,
            std::span<const Coordinates> coordinates, std::span<const double> scales,
            const SampleOptions& options, std::span<float> result) {
  check_pyramid(pyramid);
  if (table != nullptr) check_table(*table);
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
        std::vector<double> sums(channels);
        for (std::int64_t i = begin; i < end; ++i) {
          const WeightedTexels found = weigh_texels(pyramid, table, options.wrap, coordinates[i][0],
                                                    coordinates[i][1], scales[is_constant ? 0 : i]);
          std::fill(sums.begin(), sums.end(), 0.0);
          if (pyramid.bytes) {
            add_texels<std::uint8_t>(pyramid, found, sums);
          } else {
            add_texels<float>(pyramid, found, sums);
          }
          const double unit = pyramid.bytes ? 1.0 / 255.0 : 1.0;
          for (std::size_t c = 0; c < channels; ++c) {
            result[i * channels + c] = static_cast<float>(sums[c] * unit);
          }
        }
      });
}

}  // namespace prefilter
