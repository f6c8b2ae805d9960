// Block compression of 8-bit texels, as graphics cards decode it (BC1, BC3, BC4, BC5).
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/progress.h"

namespace prefilter {

enum class BlockFormat {
  kBc1,  // red, green, blue, and an alpha that is 0 or 1: 8 bytes a block
  kBc3,  // red, green, blue and alpha: 16 bytes
  kBc4,  // red: 8 bytes
  kBc5,  // red and green: 16 bytes
};

struct BlockOptions {
  BlockFormat format = BlockFormat::kBc1;
  /// Whether colours of texels with little alpha count little, for kBc3.
  bool weigh_by_alpha = false;
  int threads = 0;  // 0 = one per processor
};

/// The blocks of 4 x 4 texels, row by row from the first one, of interleaved RGBA bytes. Blocks
/// that reach over the edge are fitted to the texels inside. For kBc1 texels with an alpha below
/// 128 become transparent black, and all others opaque.
///
/// Throws Error where a side is less than 1, and where `progress` cancels.
std::vector<std::uint8_t> compress_blocks(const std::uint8_t* rgba, int width, int height,
                                          const BlockOptions& options, const Progress& progress);

}  // namespace prefilter
