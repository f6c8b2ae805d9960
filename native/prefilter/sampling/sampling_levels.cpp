// SPDX-License-Identifier: GPL-3.0-or-later

// Section 6.2: texels are samples of the filter itself at whole mip values and texel centers.
#include "prefilter/sampling/sampling_levels.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/base/memory.h"
#include "prefilter/images/filters/filtered_image.h"
#include "prefilter/images/filters/separable.h"

namespace prefilter {
namespace {

// Size of a level along an axis: as many whole texels as cover the image.
int nested_size(int size, int level) { return (size - 1) / (1 << level) + 1; }

int nested_level_count(const ImageView& image) {
  int count = 1;
  while (nested_size(std::max(image.width, image.height), count - 1) > 1) ++count;
  return count;
}

void check_arguments(const ImageView& image, const SamplingLevelsOptions& options) {
  check_channels(image);
  const int most = nested_level_count(image);
  if (options.levels < 0 || options.levels > most) {
    throw_invalid("levels: " + std::to_string(options.levels) + "; an image of " +
                  std::to_string(image.width) + " x " + std::to_string(image.height) +
                  " texels has 1 to " + std::to_string(most));
  }
  check_memory("image: levels of " + std::to_string(image.width) + " x " +
                   std::to_string(image.height) + " texels",
               4.0 * 3.0 * static_cast<double>(image.value_count()));
}

// Whether filtering with the kernel at the image's own resolution changes nothing.
bool interpolates(const Kernel& kernel) {
  const Taps taps = kernel_taps(kernel, 0.5, 1.0);
  for (std::size_t i = 0; i < taps.weights.size(); ++i) {
    const bool is_own = taps.first + static_cast<int>(i) == 0;
    if (std::abs(taps.weights[i] - (is_own ? 1.0 : 0.0)) > 1e-9) return false;
  }
  return true;
}

// Empty if the texels do not change.
AxisTaps level_taps(const Kernel& kernel, int size, int level) {
  if (level == 0 && interpolates(kernel)) return {};
  const double width = std::ldexp(1.0, level);
  AxisTaps taps;
  for (int j = 0; j < nested_size(size, level); ++j) {
    taps.push_back(kernel_taps(kernel, (j + 0.5) * width, width));
  }
  return taps;
}

}  // namespace

std::vector<Image> sampling_levels(const ImageView& image, const SamplingLevelsOptions& options) {
  check_arguments(image, options);
  const int count = options.levels == 0 ? nested_level_count(image) : options.levels;
  const bool has_alpha = !options.premultiplied && (image.channels == 2 || image.channels == 4);
  const TexelSource source(image);
  const FilteredImage filtered(
      source, [&] { return std::vector<unsigned char>(image.texel_count(), 1); },
      {.alpha = has_alpha ? std::optional<int>(image.channels - 1) : std::nullopt,
       .run = options.run.part(0.0, 0.1)});
  std::vector<Image> levels;
  for (int level = 0; level < count; ++level) {
    const auto done = [&](int number) { return 0.1 + 0.9 * number / count; };
    levels.push_back(
        filter_separably(filtered.floats(), level_taps(*options.kernel, image.width, level),
                         level_taps(*options.kernel, image.height, level), options.wrap,
                         options.run.part(done(level), done(level + 1))));
  }
  options.run.report(1.0);
  return levels;
}

}  // namespace prefilter
