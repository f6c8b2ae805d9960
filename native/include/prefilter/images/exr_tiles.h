// SPDX-License-Identifier: GPL-3.0-or-later

// The tiles of mip-mapped OpenEXR files, compressed.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/image.h"

namespace prefilter {

inline constexpr int kExrTileSide = 64;

struct ExrTileOptions {
  bool half = true;         // 16-bit floats, or 32-bit ones
  bool has_alpha = false;   // whether the last channel, of two or four, is alpha
  bool multiplies = false;  // whether colors are to be multiplied by alpha
  int threads = 0;          // 0 = all processors
};

/// Chunks of a file, one after another.
struct ExrChunks {
  std::vector<std::uint8_t> bytes;
  std::vector<std::int64_t> sizes;
};

/// The tiles of some rows of tiles of level `number`, as chunks of an OpenEXR file that has the
/// channels Y; A, Y; B, G, R; or A, B, G, R, and ZIP compression. The file's first row is the
/// image's last. Halves are clipped to their range, and with `has_alpha` alpha to [0, 1]; floats
/// are not clipped.
ExrChunks exr_tiles(const TexelSource& level, int number, int first_row, int row_count,
                    const ExrTileOptions& options);

}  // namespace prefilter
