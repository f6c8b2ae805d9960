// SPDX-License-Identifier: GPL-3.0-or-later

// What compress_blocks needs of a library that encodes blocks; encoders.h lists those there are.
#pragma once

#include <cstdint>
#include <memory>

#include "prefilter/textures/compress_blocks.h"

namespace prefilter {

/// Blocks of one row of blocks. Texels beyond the image's edge repeat the last ones inside.
template <class Channel>
struct BlockRow {
  /// Interleaved RGBA, a block after the other, its rows one after the other: an image that is one
  /// block wide.
  const Channel* texels;
  int count;         // of blocks, 1 or more
  int rows_inside;   // of each block's rows, those inside of the image
  int last_columns;  // of the last block's columns, those inside of the image
};

/// Encodes blocks of one format. Several threads use one each; a block must not depend on what an
/// encoder encoded before.
template <class Channel>
class BlockEncoder {
 public:
  virtual ~BlockEncoder() = default;
  /// Writes row.count blocks, one after the other.
  virtual void encode(const BlockRow<Channel>& row, std::uint8_t* blocks) = 0;
};

using ByteEncoder = BlockEncoder<std::uint8_t>;
using HalfEncoder = BlockEncoder<HalfBits>;

}  // namespace prefilter
