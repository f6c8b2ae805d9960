// SPDX-License-Identifier: GPL-3.0-or-later

// Equation 6.1, as a sum over texels.
#include "prefilter/sampling/exact.h"

#include <algorithm>
#include <utility>

#include "prefilter/base/geometry.h"
#include "prefilter/base/parallel.h"
#include "prefilter/sampling/axis_weights.h"

namespace prefilter {
namespace {

// Adds texels row by row in double precision, so that constant images stay constant.
template <int C>
void add_texels(const ImageView& image, const AxisWeights& along_x, const AxisWeights& along_y,
                double* sums) {
  for (std::size_t j = 0; j < along_y.texels.size(); ++j) {
    const float* row = image.texel(0, along_y.texels[j]);
    double row_sums[C] = {};
    for (std::size_t i = 0; i < along_x.texels.size(); ++i) {
      const float* texel = row + static_cast<std::ptrdiff_t>(along_x.texels[i]) * C;
      for (int c = 0; c < C; ++c) row_sums[c] += along_x.weights[i] * texel[c];
    }
    for (int c = 0; c < C; ++c) sums[c] += along_y.weights[j] * row_sums[c];
  }
}

void add_channels(const ImageView& image, const AxisWeights& along_x, const AxisWeights& along_y,
                  double* sums) {
  for (std::size_t j = 0; j < along_y.texels.size(); ++j) {
    const float* row = image.texel(0, along_y.texels[j]);
    for (std::size_t i = 0; i < along_x.texels.size(); ++i) {
      const float* texel = row + static_cast<std::ptrdiff_t>(along_x.texels[i]) * image.channels;
      const double weight = along_y.weights[j] * along_x.weights[i];
      for (int c = 0; c < image.channels; ++c) sums[c] += weight * texel[c];
    }
  }
}

}  // namespace

void sample_exactly(const ImageView& image, const Kernel& kernel, WrapModes wrap,
                    const TexturePlace& place, double scale, float* values) {
  const double width = std::max(1.0, scale);
  const auto along = [&](double coordinate, int size, Wrap mode) {
    const double near = std::clamp(coordinate, -kLargestCoordinate, kLargestCoordinate);
    return axis_weights(kernel, near * size, width, size, mode);
  };
  const AxisWeights along_x = along(place[0], image.width, wrap.u);
  const AxisWeights along_y = along(place[1], image.height, wrap.v);
  std::vector<double> sums(static_cast<std::size_t>(image.channels));
  switch (image.channels) {
    case 1:
      add_texels<1>(image, along_x, along_y, sums.data());
      break;
    case 2:
      add_texels<2>(image, along_x, along_y, sums.data());
      break;
    case 3:
      add_texels<3>(image, along_x, along_y, sums.data());
      break;
    case 4:
      add_texels<4>(image, along_x, along_y, sums.data());
      break;
    default:
      add_channels(image, along_x, along_y, sums.data());
      break;
  }
  std::transform(sums.begin(), sums.end(), values,
                 [](double sum) { return static_cast<float>(sum); });
}

std::vector<float> sample_exactly(const ImageView& image, const SamplePlaces& places,
                                  const ExactOptions& options) {
  check_places(places);
  const std::size_t count = places.coordinates.size();
  const auto channels = static_cast<std::size_t>(image.channels);
  std::vector<float> values(count * channels);
  // Each sample may read the whole image.
  constexpr std::size_t kExactTexelsPerTask = 1 << 22;
  const auto at_once = static_cast<std::int64_t>(
      std::clamp<std::size_t>(kExactTexelsPerTask / image.texel_count(), 1, 64));
  parallel_ranges(static_cast<std::int64_t>(count), at_once, options.run,
                  [&](std::int64_t begin, std::int64_t end) {
                    for (auto i = static_cast<std::size_t>(begin); std::cmp_less(i, end); ++i) {
                      sample_exactly(image, *options.kernel, options.wrap, places.coordinates[i],
                                     places.scale(i), values.data() + i * channels);
                    }
                  });
  options.run.report(1.0);
  return values;
}

}  // namespace prefilter
