// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/sample.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/sampling/pyramid_sampler.h"

namespace prefilter {
namespace {

constexpr std::int64_t kSamplesOfRange = 1 << 12;

}  // namespace

void sample(const Pyramid& pyramid, const SamplingTable* table,
            std::span<const TexturePlace> coordinates, std::span<const double> scales,
            const SampleOptions& options, std::span<float> result) {
  const PyramidSampler sampler(pyramid, table, options.wrap);
  check_scale_count({coordinates, scales});
  const auto channels = static_cast<std::size_t>(pyramid.channels);
  if (result.size() != coordinates.size() * channels) {
    throw_invalid("result: found " + std::to_string(result.size()) + " values; " +
                  std::to_string(coordinates.size() * channels) + " are needed");
  }
  const bool is_constant = scales.size() == 1;
  if (is_constant) check_scales(scales);
  parallel_ranges(static_cast<std::int64_t>(coordinates.size()), kSamplesOfRange, options.run,
                  [&](std::int64_t begin, std::int64_t end) {
                    const auto count = static_cast<std::size_t>(end - begin);
                    check_coordinates(coordinates.subspan(begin, count), begin);
                    if (!is_constant) check_scales(scales.subspan(begin, count), begin);
                    sampler.sample(coordinates.subspan(begin, count),
                                   is_constant ? scales : scales.subspan(begin, count),
                                   result.data() + begin * channels);
                  });
}

}  // namespace prefilter
