// SPDX-License-Identifier: GPL-3.0-or-later

// Compresses the tiles of mip-mapped OpenEXR files.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/image.h"

namespace prefilter {

inline constexpr int kExrTileSide = 64;

struct ExrTileOptions {
  bool half = true;         // 16-bit floats, or 32-bit
  bool has_alpha = false;   // whether the last of two or four channels is alpha
  bool multiplies = false;  // whether to multiply colors by alpha
  int threads = 0;          // 0 = all processors
};

/// Consecutive chunks of a file, and the size of each.
struct ExrChunks {
  std::vector<std::uint8_t> bytes;
  std::vector<std::int64_t> sizes;
};

/// The tiles in some tile rows of level `number`, as chunks of an OpenEXR file with ZIP compression
/// and the channels Y; A, Y; B, G, R; or A, B, G, R. The file's first row is the image's last.
/// Halves are clipped to their range, and alpha to [0, 1] if `has_alpha`; floats are not clipped.
ExrChunks exr_tiles(const TexelSource& level, int number, int first_row, int row_count,
                    const ExrTileOptions& options);

}  // namespace prefilter
