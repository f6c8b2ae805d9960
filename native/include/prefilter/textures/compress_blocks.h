// SPDX-License-Identifier: GPL-3.0-or-later

// Texels compressed in blocks, as graphics cards decode them.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/textures/block_effort.h"
#include "prefilter/textures/block_layout.h"

namespace prefilter {

/// Images with no more texels get the effort above the one that is asked for.
constexpr int kMostCoarseTexels = 64 * 64;

struct BlockOptions {
  BlockFormat format = BlockFormat::kBc1;
  /// Whether colors of texels with little alpha count little, for kBc3 and ASTC.
  bool weigh_by_alpha = false;
  /// Whether red, green and blue are sRGB-encoded, for ASTC, whose decoders then round otherwise.
  bool is_srgb = false;
  BlockEffort effort = BlockEffort::kNormal;
  int threads = 0;  // 0 = one per processor
};

/// A half float as IEEE 754 stores it.
using HalfBits = std::uint16_t;

/// The blocks, row by row from the first one, of interleaved RGBA bytes. Blocks that reach over the
/// edge are fitted to the texels inside. For kBc1 texels with an alpha below 128 become transparent
/// black, and all others opaque; kBc1Rgb ignores alpha.
///
/// Throws Error where a side is less than 1, where the format is one of floats, and where
/// `progress` cancels.
std::vector<std::uint8_t> compress_blocks(const std::uint8_t* rgba, int width, int height,
                                          const BlockOptions& options, const Progress& progress);

/// The same for formats of floats, of finite half floats. Negative values become 0.
std::vector<std::uint8_t> compress_blocks(const HalfBits* rgba, int width, int height,
                                          const BlockOptions& options, const Progress& progress);

}  // namespace prefilter
