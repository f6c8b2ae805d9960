// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "prefilter/sampling/sample_block.h"
#include "prefilter/sampling/texel_sums.h"

namespace prefilter {
namespace {

/// The four texels of a level around a sample, and its position between them.
struct Square {
  std::array<std::array<const void*, 2>, 2> texels;  // [y][x]
  float x;
  float y;
};

/// The squares of a sample in both levels, the coarser first. For magnification both are in level
/// 0.
using TexelSquares = std::array<Square, 2>;

inline void find_square(const WrappedPyramid& pyramid, int level, Pair uv, Square& square) {
  const PyramidLevel& texels = pyramid.pyramid.levels[level];
  const Pair size{static_cast<double>(texels.width), static_cast<double>(texels.height)};
  const Pair at = uv * Pair{texels.columns, texels.rows} - 0.5;
  const Pair low = floor_pair(at);
  const Pair share = at - low;
  square.x = static_cast<float>(share[0]);
  square.y = static_cast<float>(share[1]);
  if (is_between(Pair{}, low, size - 2.0)) {
    const std::size_t pitch = pyramid.pyramid.texel_size();
    const std::size_t row = pitch * static_cast<std::size_t>(texels.width);
    const auto* const corner = static_cast<const std::byte*>(texels.texels) +
                               static_cast<std::size_t>(low[1]) * row +
                               static_cast<std::size_t>(low[0]) * pitch;
    square.texels = {{{corner, corner + pitch}, {corner + row, corner + row + pitch}}};
    return;
  }
  const int x = static_cast<int>(low[0]);
  const int y = static_cast<int>(low[1]);
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      square.texels[j][i] = pyramid.texel(level, x + i, y + j);
    }
  }
}

/// Interpolates bilinearly, from a channel on.
template <typename Channels, typename Value>
inline Channels mix_square(const Square& square, int channel) {
  const auto load = [channel](const void* texel) {
    return Channels::load(static_cast<const Value*>(texel) + channel);
  };
  const auto& [low, high] = square.texels;
  return mix(mix(load(low[0]), load(low[1]), square.x), mix(load(high[0]), load(high[1]), square.x),
             square.y);
}

template <typename Value>
void mix_block(const Pyramid& pyramid, const SampleBlock& block, const TexelSquares* squares,
               float* result) {
  constexpr float kUnit = sizeof(Value) == 1 ? 1.0F / 255.0F : 1.0F;
  for (int i = 0; i < block.count; ++i) {
    const auto& [coarse, fine] = squares[i];
    const bool magnifies = block.cell_levels[i] == 0;
    for_channels(pyramid.channels, [&]<typename Channels>(int channel) {
      Channels value = mix_square<Channels, Value>(fine, channel);
      if (!magnifies) value = mix(value, mix_square<Channels, Value>(coarse, channel), block.f[i]);
      (value * kUnit).store(result + channel);
    });
    result += pyramid.channels;
  }
}

}  // namespace

void sample_block_trilinearly(const WrappedPyramid& pyramid, const SampleBlock& block,
                              float* result) {
  std::array<TexelSquares, kBlockSamples> squares;
  for (int i = 0; i < block.count; ++i) {
    const int level = block.cell_levels[i];
    auto& [coarse, fine] = squares[i];
    find_square(pyramid, level, block.coordinates[i], coarse);
    find_square(pyramid, std::max(level - 1, 0), block.coordinates[i], fine);
  }
  if (pyramid.pyramid.bytes) {
    mix_block<std::uint8_t>(pyramid.pyramid, block, squares.data(), result);
  } else {
    mix_block<float>(pyramid.pyramid, block, squares.data(), result);
  }
}

}  // namespace prefilter
