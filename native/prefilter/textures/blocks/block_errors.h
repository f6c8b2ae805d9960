// SPDX-License-Identifier: GPL-3.0-or-later

// Errors of encoded blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/textures/blocks/block_decoder.h"
#include "prefilter/textures/blocks/block_encoder.h"

namespace prefilter {

/// The channels to compare: the first one in a source texel and in a decoded texel, and their
/// number.
struct ComparedChannels {
  std::ptrdiff_t of_texel;
  std::ptrdiff_t of_decoded;
  int count;
};

/// Decodes 4 x 4 blocks, side by side.
inline std::vector<std::uint8_t> decoded_row(ByteDecoder* decoder, const std::uint8_t* blocks,
                                             int count) {
  std::vector<std::uint8_t> texels(static_cast<std::size_t>(4 * 16 * count));
  decoder->decode(blocks, count, texels.data());
  return texels;
}

/// Squared error of each block over the texels inside the image. `decoded` is the result of
/// `decoded_row`.
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
