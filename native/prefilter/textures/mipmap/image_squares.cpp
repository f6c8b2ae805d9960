// SPDX-License-Identifier: GPL-3.0-or-later

// Exact integrals over cells, from the moments of the image.
#include "prefilter/textures/mipmap/image_squares.h"

#include "prefilter/geometry/moments/four_point_rule.h"

namespace prefilter {
namespace {

// `moments_at(i, j)` returns the image moments of a cell.
template <int C, typename MomentsAt>
ChannelSums integral_of(const MomentBlock<C>& block, const MomentsAt& moments_at,
                        const ImageView& image, WrapModes wrap) {
  const CellPlace* x_places = block.x_places(0);
  const CellPlace* y_places = block.y_places(0);
  ChannelSums sums{};
  for (int j = 0; j < block.height; ++j) {
    const auto& [y, size_y] = y_places[j].placement;
    for (int i = 0; i < block.width; ++i) {
      if (block.at(i, j).empty()) continue;
      const ChannelMoments<C>& channels = moments_at(i, j);
      const auto& [x, size_x] = x_places[i].placement;
      const float* corners[4];
      for (int k = 0; k < 4; ++k) {
        const int column = wrap_index(x_places[i].texel + k % 2, image.width, wrap.u);
        const int row = wrap_index(y_places[j].texel + k / 2, image.height, wrap.v);
        corners[k] = column < 0 || row < 0 ? nullptr : image.texel(column, row);
      }
      for (int c = 0; c < C; ++c) {
        double v[4];
        for (int k = 0; k < 4; ++k) v[k] = corners[k] == nullptr ? 0.0 : corners[k][c];
        // p00 + p10 x + p01 y + p11 x y in the cell's own coordinates.
        const double slope_x = v[1] - v[0];
        const double slope_y = v[2] - v[0];
        const double twist = v[3] - v[2] - v[1] + v[0];
        const ImageMoments& moments = channels[c];
        sums[c] += (v[0] + slope_x * x + slope_y * y + twist * x * y) * moments[0] +
                   size_x * (slope_x + twist * y) * moments[1] +
                   size_y * (slope_y + twist * x) * moments[2] +
                   size_x * size_y * twist * moments[3];
      }
    }
  }
  return sums;
}

}  // namespace

template <int C>
ChannelSums integral_with(const MomentBlock<C>& block, const ImageView& image, WrapModes wrap) {
  const auto moments_at = [&](int i, int j) -> const auto& { return block.at(i, j).image; };
  return integral_of(block, moments_at, image, wrap);
}

template <int C>
ChannelSums integral_of_means_with(const MomentBlock<C>& block, const ImageView& image,
                                   WrapModes wrap) {
  const auto moments_at = [&](int i, int j) -> const auto& { return block.means_at(i, j); };
  return integral_of(block, moments_at, image, wrap);
}

template <int C>
ChannelSums integral_of_decoded_square(const MomentBlock<C>& block) {
  ChannelSums sums{};
  for (int j = 0; j < block.height; ++j) {
    for (int i = 0; i < block.width; ++i) {
      const CellMoments<C>& cell = block.at(i, j);
      if (cell.empty()) continue;
      const FourPointRule rule(cell.weight);
      for (int c = 0; c < C; ++c) {
        const std::array<double, 4> integrals = rule.integrals(cell.image[c]);
        for (int k = 0; k < 4; ++k) {
          // Points with a negligible weight carry no information about the image.
          if (!(rule.weight(k) > 1e-9 * cell.weight[0])) continue;
          sums[c] += integrals[k] * integrals[k] / rule.weight(k);
        }
      }
    }
  }
  return sums;
}

ChannelSums BlockSums::total() const {
  ChannelSums total{};
  for (const ChannelSums& part : parts_) {
    for (int c = 0; c < kMaxChannels; ++c) total[c] += part[c];
  }
  return total;
}

template ChannelSums integral_with<1>(const MomentBlock<1>&, const ImageView&, WrapModes);
template ChannelSums integral_with<2>(const MomentBlock<2>&, const ImageView&, WrapModes);
template ChannelSums integral_with<3>(const MomentBlock<3>&, const ImageView&, WrapModes);
template ChannelSums integral_with<4>(const MomentBlock<4>&, const ImageView&, WrapModes);
template ChannelSums integral_of_means_with<1>(const MomentBlock<1>&, const ImageView&, WrapModes);
template ChannelSums integral_of_means_with<2>(const MomentBlock<2>&, const ImageView&, WrapModes);
template ChannelSums integral_of_means_with<3>(const MomentBlock<3>&, const ImageView&, WrapModes);
template ChannelSums integral_of_means_with<4>(const MomentBlock<4>&, const ImageView&, WrapModes);
template ChannelSums integral_of_decoded_square<1>(const MomentBlock<1>&);
template ChannelSums integral_of_decoded_square<2>(const MomentBlock<2>&);
template ChannelSums integral_of_decoded_square<3>(const MomentBlock<3>&);
template ChannelSums integral_of_decoded_square<4>(const MomentBlock<4>&);

}  // namespace prefilter
