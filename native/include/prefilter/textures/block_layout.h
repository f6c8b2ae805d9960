// SPDX-License-Identifier: GPL-3.0-or-later

// The formats of compressed blocks: how many texels and bytes a block has.
#pragma once

#include <span>
#include <string>

namespace prefilter {

enum class BlockFormat {
  kBc1,       // red, green, blue, and an alpha that is 0 or 1
  kBc1Rgb,    // the same blocks, opaque
  kBc3,       // red, green, blue and alpha
  kBc4,       // red
  kBc5,       // red and green
  kBc6h,      // red, green and blue, of floats that are not negative
  kBc7,       // red, green, blue and alpha
  kEtc2Rgb,   // red, green and blue
  kEtc2Rgba,  // red, green, blue and alpha
  kEacR11,    // red
  kEacRg11,   // red and green
  kAstc4x4,   // red, green, blue and alpha, as are the following
  kAstc6x6,
  kAstc8x8,
  kAstc4x4Hdr,  // with an alpha from 0 to 1
  kAstc6x6Hdr,
  kUastc,
};

struct BlockLayout {
  BlockFormat format;
  const char* name;  // as Python knows it, such as "bc1"
  int columns;       // texels along a block's sides
  int rows;
  int bytes;
  bool is_float;  // compressed from half floats, not from bytes
};

std::span<const BlockLayout> block_layouts();

const BlockLayout& layout_of(BlockFormat format);

/// The format of that name.
///
/// Throws Error where there is none.
const BlockLayout& layout_named(const std::string& name);

}  // namespace prefilter
