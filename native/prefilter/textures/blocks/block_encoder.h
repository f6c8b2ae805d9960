// SPDX-License-Identifier: GPL-3.0-or-later

// The interface of block encoders; encoders.h lists them.
#pragma once

#include <cstdint>
#include <memory>

#include "prefilter/textures/compress_blocks.h"

namespace prefilter {

/// A row of blocks. Texels beyond the edges of the image repeat the last ones inside.
template <class Channel>
struct BlockRow {
  /// Interleaved RGBA, block by block and row by row in each: an image one block wide.
  const Channel* texels;
  int count;         // number of blocks, at least 1
  int rows_inside;   // rows of each block inside the image
  int last_columns;  // columns of the last block inside the image
};

/// Encodes blocks of one format. Each thread uses its own encoder. Blocks must not depend on
/// earlier ones.
template <class Channel>
class BlockEncoder {
 public:
  virtual ~BlockEncoder() = default;
  /// Writes row.count consecutive blocks.
  virtual void encode(const BlockRow<Channel>& row, std::uint8_t* blocks) = 0;
};

using ByteEncoder = BlockEncoder<std::uint8_t>;
using HalfEncoder = BlockEncoder<HalfBits>;

}  // namespace prefilter
