// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/mipmap/level_sums.h"

#include "prefilter/textures/mipmap/image_squares.h"
#include "prefilter/textures/texels/levels.h"

namespace prefilter {

template <int C>
LevelSystems<C>::LevelSystems(int width, int height, int level_count, WrapModes wrap, Reader reader)
    : width_(width), height_(height), wrap_(wrap) {
  for (int level = 1; level < level_count; ++level) {
    const int own_width = level_size(width, level);
    const int own_height = level_size(height, level);
    linear.push_back(std::make_unique<BilinearSystem<C>>(own_width, own_height, wrap));
    if (reader == Reader::kLinear) continue;
    encoded.push_back(std::make_unique<EncodedFit<C>>(own_width, own_height, width, height, wrap));
  }
}

template <int C>
void LevelSystems<C>::add(const MomentBlock<C>& block) {
  const auto k = static_cast<std::size_t>(block.level - 1);
  linear[k]->add(block);
  if (!encoded.empty()) encoded[k]->add(block);
  if (k < couplings.size()) couplings[k].add(block);
}

template <int C>
void LevelSystems<C>::expect_finer_means() {
  const auto last_level = static_cast<int>(linear.size());
  for (const auto& system : linear) system->expect_finer_means();
  for (int level = 1; level < last_level; ++level) {
    couplings.emplace_back(level_size(width_, level), level_size(height_, level),
                           level_size(width_, level + 1), level_size(height_, level + 1), wrap_);
  }
}

template <int C>
void LevelSystems<C>::add_coupled_means(const Run& run) {
  prefilter::add_coupled_means(couplings, linear, run);
  std::vector<LevelCoupling>().swap(couplings);
}

template <int C>
TargetSquares sum_image(const TexelTriangles& triangles, const SweptImage& image, WrapModes wrap,
                        Reader reader, bool has_squares, int last_level, const Run& run,
                        const AddBlock<C>& add) {
  const TexelSource& swept = image.swept;
  BlockSums of_image(swept.width, swept.height);
  BlockSums of_means(swept.width, swept.height);
  BlockSums of_both(swept.width, swept.height);
  const auto add_squares = [&](const MomentBlock<C>& block) {
    of_image.add(block.index, reader == Reader::kSrgbAfter
                                  ? integral_of_decoded_square(block)
                                  : integral_with(block, image.floats, wrap));
    if (image.means == nullptr) return;
    of_means.add(block.index, integral_of_means_with(block, image.means->view(), wrap));
    of_both.add(block.index, integral_of_means_with(block, image.floats, wrap));
  };
  sweep_moments<C>(
      triangles, swept, wrap,
      {.first_level = has_squares ? 0 : 1,
       .last_level = last_level,
       .reader = reader,
       .means = image.means},
      run, [&](const MomentBlock<C>& block) { block.level > 0 ? add(block) : add_squares(block); });
  return {of_image.total(), of_means.total(), of_both.total()};
}

#define PREFILTER_INSTANTIATE(C)                                                                   \
  template struct LevelSystems<C>;                                                                 \
  template TargetSquares sum_image<C>(const TexelTriangles&, const SweptImage&, WrapModes, Reader, \
                                      bool, int, const Run&, const AddBlock<C>&)
PREFILTER_INSTANTIATE(1);
PREFILTER_INSTANTIATE(2);
PREFILTER_INSTANTIATE(3);
PREFILTER_INSTANTIATE(4);
#undef PREFILTER_INSTANTIATE

}  // namespace prefilter
