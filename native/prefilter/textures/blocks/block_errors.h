// SPDX-License-Identifier: GPL-3.0-or-later

// How far blocks are from the texels that they stand for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/textures/blocks/block_decoder.h"
#include "prefilter/textures/blocks/block_encoder.h"

namespace prefilter {

/// Channels that are compared: where the first is in a texel, where in what a decoder writes, and
/// how many there are.
struct ComparedChannels {
  std::ptrdiff_t of_texel;
  std::ptrdiff_t of_decoded;
  int count;
};

/// Blocks of 4 x 4, decoded one beside the other.
inline std::vector<std::uint8_t> decoded_row(ByteDecoder* decoder, const std::uint8_t* blocks,
                                             int count) {
  std::vector<std::uint8_t> texels(static_cast<std::size_t>(4 * 16 * count));
  decoder->decode(blocks, count, texels.data());
  return texels;
}

/// The sum of squares over the texels inside of the image, by block, of what `decoded_row` returns.
inline std::vector<std::int64_t> squared_errors(const BlockRow<std::uint8_t>& row,
                                                const std::vector<std::uint8_t>& decoded,
                                                const ComparedChannels& channels) {
  constexpr std::ptrdiff_t kSide = 4, kChannels = 4;
  std::vector<std::int64_t> sums(static_cast<std::size_t>(row.count));
  for (std::ptrdiff_t i = 0; i < row.count; ++i) {
    const std::ptrdiff_t columns = i == row.count - 1 ? row.last_columns : kSide;
    int sum = 0;
    for (std::ptrdiff_t y = 0; y < row.rows_inside; ++y) {
      for (std::ptrdiff_t x = 0; x < columns; ++x) {
        const std::uint8_t* texel = row.texels + kChannels * (kSide * (kSide * i + y) + x);
        const std::uint8_t* found = decoded.data() + kChannels * (kSide * (row.count * y + i) + x);
        for (int c = 0; c < channels.count; ++c) {
          const int off = texel[channels.of_texel + c] - found[channels.of_decoded + c];
          sum += off * off;
        }
      }
    }
    sums[static_cast<std::size_t>(i)] = sum;
  }
  return sums;
}

}  // namespace prefilter
