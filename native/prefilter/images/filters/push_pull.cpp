// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/filters/push_pull.h"

#include <algorithm>
#include <cassert>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

struct Layer {
  Image image;                 // weighted means; undefined where the weight is 0
  std::vector<float> weights;  // clamped to 1, so that full texels are not outvoted
};

Layer pull(const Layer& fine, int channels, const Run& run) {
  const int width = (fine.image.width + 1) / 2;
  const int height = (fine.image.height + 1) / 2;
  Layer coarse{Image(width, height, fine.image.channels),
               std::vector<float>(static_cast<std::size_t>(width) * height)};
  parallel_for(height, run, [&](std::int64_t row) {
    const int coarse_y = static_cast<int>(row);
    float* weights = coarse.weights.data() + static_cast<std::ptrdiff_t>(coarse_y) * width;
    for (int y = 2 * coarse_y; y < std::min(2 * coarse_y + 2, fine.image.height); ++y) {
      for (int x = 0; x < fine.image.width; ++x) {
        const float weight = fine.weights[static_cast<std::size_t>(y) * fine.image.width + x];
        if (!(weight > 0.0F)) continue;
        weights[x / 2] += weight;
        const float* from = fine.image.texel(x, y);
        float* to = coarse.image.texel(x / 2, coarse_y);
        for (int c = 0; c < channels; ++c) to[c] += weight * from[c];
      }
    }
    for (int x = 0; x < width; ++x) {
      if (!(weights[x] > 0.0F)) continue;
      float* mean = coarse.image.texel(x, coarse_y);
      for (int c = 0; c < channels; ++c) mean[c] /= weights[x];
      weights[x] = std::min(weights[x], 1.0F);
    }
  });
  return coarse;
}

void push_row(const Image& coarse, WrapModes wrap, int channels, int y, Layer* fine) {
  // Fills use the nearest texel at the border, as zeros would bleed in.
  const auto at = [](int index, int size, Wrap mode) {
    return wrap_index(index, size, mode == Wrap::kRepeat ? mode : Wrap::kClamp);
  };
  for (int x = 0; x < fine->image.width; ++x) {
    if (fine->weights[static_cast<std::size_t>(y) * fine->image.width + x] > 0.0F) continue;
    // The center of a fine texel is a quarter of a coarse texel away from its parent's center.
    const int columns[2] = {x / 2, x / 2 + (x % 2 == 0 ? -1 : 1)};
    const int rows[2] = {y / 2, y / 2 + (y % 2 == 0 ? -1 : 1)};
    float* target = fine->image.texel(x, y);
    std::fill_n(target, channels, 0.0F);
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 2; ++i) {
        const float* source =
            coarse.texel(at(columns[i], coarse.width, wrap.u), at(rows[j], coarse.height, wrap.v));
        const float share = (i == 0 ? 0.75F : 0.25F) * (j == 0 ? 0.75F : 0.25F);
        for (int c = 0; c < channels; ++c) target[c] += share * source[c];
      }
    }
  }
}

}  // namespace

void fill_holes(const std::vector<float>& weights, WrapModes wrap, int channels, const Run& run,
                Image* image) {
  assert(weights.size() == image->view().texel_count());
  const bool any_hole =
      std::any_of(weights.begin(), weights.end(), [](float w) { return !(w > 0.0F); });
  const bool any_value =
      std::any_of(weights.begin(), weights.end(), [](float w) { return w > 0.0F; });
  if (!any_hole || !any_value) return;

  std::vector<Layer> layers;
  layers.push_back({std::move(*image), weights});
  const Stages stages(run, {4, 1, 1, 4});
  while (layers.back().image.width > 1 || layers.back().image.height > 1) {
    // The first layer takes most of the time.
    const Run part = layers.size() == 1 ? stages[0] : stages[1];
    layers.push_back(pull(layers.back(), channels, part));
  }
  for (std::size_t k = layers.size() - 1; k > 0; --k) {
    const Run part = k == 1 ? stages[3] : stages[2];
    parallel_for(layers[k - 1].image.height, part, [&](std::int64_t y) {
      push_row(layers[k].image, wrap, channels, static_cast<int>(y), &layers[k - 1]);
    });
  }
  *image = std::move(layers[0].image);
}

}  // namespace prefilter
