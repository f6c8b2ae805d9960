// SPDX-License-Identifier: GPL-3.0-or-later

// What decode_blocks needs of a library that decodes blocks; decoders.h lists those there are.
#pragma once

#include <cstdint>
#include <memory>

#include "prefilter/textures/decode_blocks.h"

namespace prefilter {

/// Decodes blocks of one format. Several threads use one each.
template <class Channel>
class BlockDecoder {
 public:
  virtual ~BlockDecoder() = default;
  /// Writes interleaved RGBA of a row of `count` blocks, one image of all of them: as many texels
  /// wide as they have columns. Alpha is whole, and channels that lack are 0, before it is called.
  virtual void decode(const std::uint8_t* blocks, int count, Channel* texels) = 0;
};

using ByteDecoder = BlockDecoder<std::uint8_t>;
using HalfDecoder = BlockDecoder<HalfBits>;

}  // namespace prefilter
