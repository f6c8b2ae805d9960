// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/mipmap/texture_space.h"

#include "prefilter/base/parallel.h"
#include "prefilter/images/filters/push_pull.h"
#include "prefilter/images/filters/separable.h"
#include "prefilter/textures/texels/levels.h"

namespace prefilter {
namespace {

constexpr float kMinKernelWeight = 0.1F;

}  // namespace

Image filter_level(const ImageView& image, int level, const Kernel& kernel, WrapModes wrap,
                   const Run& run) {
  return filter_separably(image, level_size(image.width, level), level_size(image.height, level),
                          kernel, wrap, run);
}

Image filter_covered_level(const ImageView& image, const std::vector<unsigned char>& covered,
                           int level, const Kernel& kernel, WrapModes wrap, const Run& run) {
  Image masked(image.width, image.height, image.channels);
  Image mask(image.width, image.height, 1);
  parallel_for(image.height, run.part(0.0, 0.1), [&](std::int64_t row) {
    const std::size_t begin = static_cast<std::size_t>(row) * image.width;
    for (std::size_t i = begin; i < begin + image.width; ++i) {
      if (covered[i] == 0) continue;
      mask.data[i] = 1.0F;
      for (int c = 0; c < image.channels; ++c) {
        const std::size_t at = i * static_cast<std::size_t>(image.channels) + c;
        masked.data[at] = image.data[at];
      }
    }
  });
  const int width = level_size(image.width, level);
  const int height = level_size(image.height, level);
  const auto reduce = [&](const Image& source, const Kernel& with, double from, double to) {
    return filter_separably(source.view(), width, height, with, wrap, run.part(from, to));
  };
  Image sums = reduce(masked, kernel, 0.1, 0.4);
  Image weights = reduce(mask, kernel, 0.4, 0.5);
  const Image box_sums = reduce(masked, box_kernel(), 0.5, 0.8);
  const Image box_weights = reduce(mask, box_kernel(), 0.8, 0.9);
  for (std::size_t i = 0; i < weights.data.size(); ++i) {
    const bool box = weights.data[i] < kMinKernelWeight;
    const float weight = box ? box_weights.data[i] : weights.data[i];
    for (int c = 0; c < image.channels && box_weights.data[i] > 0.0F; ++c) {
      const std::size_t at = i * static_cast<std::size_t>(image.channels) + c;
      sums.data[at] = (box ? box_sums : sums).data[at] / weight;
    }
  }
  fill_holes(box_weights.data, wrap, image.channels, run.part(0.9, 1.0), &sums);
  return sums;
}

}  // namespace prefilter
