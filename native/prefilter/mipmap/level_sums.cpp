// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/mipmap/level_sums.h"

#include "prefilter/mipmap/image_squares.h"
#include "prefilter/texels/levels.h"

namespace prefilter {

template <int C>
LevelSystems<C>::LevelSystems(int width, int height, int level_count, WrapModes wrap,
                              Reader reader) {
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
  linear[block.level - 1]->add(block);
  if (!encoded.empty()) encoded[block.level - 1]->add(block);
}

template <int C>
std::vector<Image> LevelSystems<C>::means() const {
  std::vector<Image> means(1);
  for (std::size_t k = 0; k + 1 < linear.size(); ++k) means.push_back(linear[k]->means());
  return means;
}

template <int C>
void LevelSystems<C>::expect_finer_means() {
  for (const auto& system : linear) system->expect_finer_means();
}

template <int C>
void LevelSystems<C>::add_finer_means(const MomentBlock<C>& block) {
  linear[block.level - 1]->add_finer_means(block);
}

template <int C>
ChannelSums sum_image(const TexelTriangles& triangles, const TexelSource& swept,
                      const ImageView& floats, WrapModes wrap, Reader reader, bool has_squares,
                      int last_level, const Progress& progress, int threads,
                      const AddBlock<C>& add) {
  BlockSums squares(swept.width, swept.height);
  sweep_moments<C>(triangles, swept, wrap,
                   {.first_level = has_squares ? 0 : 1,
                    .last_level = last_level,
                    .reader = reader,
                    .threads = threads},
                   progress, [&](const MomentBlock<C>& block) {
                     if (block.level > 0) return add(block);
                     squares.add(block.index, reader == Reader::kSrgbAfter
                                                  ? integral_of_decoded_square(block)
                                                  : integral_with(block, floats, wrap));
                   });
  return squares.total();
}

template <int C>
void sum_means(const TexelTriangles& triangles, const ImageView& image_means,
               const std::vector<Image>& level_means, const ImageView& floats, WrapModes wrap,
               bool has_squares, const Progress& progress, int threads, const AddBlock<C>& add,
               TargetSquares* squares) {
  BlockSums of_means(floats.width, floats.height);
  BlockSums of_both(floats.width, floats.height);
  sweep_moments<C>(triangles, TexelSource(image_means), wrap,
                   {.first_level = has_squares ? 0 : 1,
                    .last_level = static_cast<int>(level_means.size()),
                    .level_images = &level_means,
                    .threads = threads},
                   progress, [&](const MomentBlock<C>& block) {
                     if (block.level > 0) return add(block);
                     of_means.add(block.index, integral_with(block, image_means, wrap));
                     of_both.add(block.index, integral_with(block, floats, wrap));
                   });
  squares->means = of_means.total();
  squares->image_means = of_both.total();
}

#define PREFILTER_INSTANTIATE(C)                                                                 \
  template struct LevelSystems<C>;                                                               \
  template ChannelSums sum_image<C>(const TexelTriangles&, const TexelSource&, const ImageView&, \
                                    WrapModes, Reader, bool, int, const Progress&, int,          \
                                    const AddBlock<C>&);                                         \
  template void sum_means<C>(const TexelTriangles&, const ImageView&, const std::vector<Image>&, \
                             const ImageView&, WrapModes, bool, const Progress&, int,            \
                             const AddBlock<C>&, TargetSquares*)
PREFILTER_INSTANTIATE(1);
PREFILTER_INSTANTIATE(2);
PREFILTER_INSTANTIATE(3);
PREFILTER_INSTANTIATE(4);
#undef PREFILTER_INSTANTIATE

}  // namespace prefilter
