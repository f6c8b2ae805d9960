// SPDX-License-Identifier: GPL-3.0-or-later

// The interface of block decoders; decoders.h lists them.
#pragma once

#include <cstdint>
#include <memory>

#include "prefilter/textures/decode_blocks.h"

namespace prefilter {

/// Decodes blocks of one format. Each thread uses its own decoder.
template <class Channel>
class BlockDecoder {
 public:
  virtual ~BlockDecoder() = default;
  /// Decodes `count` blocks to interleaved RGBA, as one image as wide as all of them. Before the
  /// call, alpha is opaque and the colors are 0, for channels missing in the format.
  virtual void decode(const std::uint8_t* blocks, int count, Channel* texels) = 0;
};

using ByteDecoder = BlockDecoder<std::uint8_t>;
using HalfDecoder = BlockDecoder<HalfBits>;

}  // namespace prefilter
