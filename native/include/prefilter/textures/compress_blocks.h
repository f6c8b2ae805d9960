// SPDX-License-Identifier: GPL-3.0-or-later

// Compresses images to the block formats that graphics cards decode.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/textures/block_effort.h"
#include "prefilter/textures/block_layout.h"

namespace prefilter {

/// Images with at most this many texels are compressed one effort higher than asked for.
constexpr int kMaxCoarseTexels = 64 * 64;

struct BlockOptions {
  BlockFormat format = BlockFormat::kBc1;
  /// For kBc3 and ASTC: weight the color error of a texel by its alpha.
  bool weigh_by_alpha = false;
  /// For ASTC: red, green and blue are sRGB-encoded. Decoders of such blocks round differently.
  bool is_srgb = false;
  BlockEffort effort = BlockEffort::kNormal;
};

/// The bits of an IEEE 754 half float.
using HalfBits = std::uint16_t;

/// Compresses interleaved RGBA bytes to blocks in row-major order. Blocks that cross the right or
/// last edge are fitted to the texels inside the image. kBc1 turns texels with an alpha below 128
/// into transparent black and makes all others opaque; kBc1Rgb ignores alpha.
///
/// Throws Error if a side is less than 1, if the format stores floats, or if `progress` cancels.
std::vector<std::uint8_t> compress_blocks(const std::uint8_t* rgba, int width, int height,
                                          const BlockOptions& options, const Run& run);

/// The same for the float formats, from finite half floats. Negative values become 0.
std::vector<std::uint8_t> compress_blocks(const HalfBits* rgba, int width, int height,
                                          const BlockOptions& options, const Run& run);

}  // namespace prefilter
