// SPDX-License-Identifier: GPL-3.0-or-later

// The formats of compressed blocks: how many texels and bytes a block has.
#pragma once

#include <span>
#include <string>

namespace prefilter {

enum class BlockFormat {
  kBc1,       // RGB and an alpha that is 0 or 1
  kBc1Rgb,    // the same blocks, opaque
  kBc3,       // RGBA
  kBc4,       // R
  kBc5,       // RG
  kBc6h,      // RGB, nonnegative half floats
  kBc7,       // RGBA
  kEtc2Rgb,   // RGB
  kEtc2Rgba,  // RGBA
  kEacR11,    // R
  kEacRg11,   // RG
  kAstc4x4,   // RGBA, as all formats below
  kAstc6x6,
  kAstc8x8,
  kAstc4x4Hdr,  // HDR RGB; alpha from 0 to 1
  kAstc6x6Hdr,
  kUastc,
};

struct BlockLayout {
  BlockFormat format;
  const char* name;  // its name in Python, such as "bc1"
  int columns;       // texels along a block's sides
  int rows;
  int bytes;
  bool is_float;  // compressed from half floats, not from bytes
};

std::span<const BlockLayout> block_layouts();

const BlockLayout& layout_of(BlockFormat format);

/// The format with that name. Throws Error if there is none.
const BlockLayout& layout_named(const std::string& name);

}  // namespace prefilter
