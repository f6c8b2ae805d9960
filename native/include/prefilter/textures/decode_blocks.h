// SPDX-License-Identifier: GPL-3.0-or-later

// Decodes compressed blocks to texels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/textures/block_layout.h"
#include "prefilter/textures/compress_blocks.h"

namespace prefilter {

struct DecodeOptions {
  BlockFormat format = BlockFormat::kBc1;
  /// For ASTC: red, green and blue are sRGB-encoded. Decoders of such blocks round differently.
  bool is_srgb = false;
};

/// Decodes blocks in the order of compress_blocks to width x height interleaved RGBA bytes. Color
/// channels missing in the format become 0, a missing alpha 255.
///
/// Throws Error if a side is less than 1, if the number of bytes does not match the size, if the
/// format stores floats, if a kUastc block is damaged, or if `progress` cancels.
std::vector<std::uint8_t> decode_blocks(std::span<const std::uint8_t> blocks, int width, int height,
                                        const DecodeOptions& options, const Run& run);

/// The same for the float formats; a missing alpha becomes 1.
std::vector<HalfBits> decode_half_blocks(std::span<const std::uint8_t> blocks, int width,
                                         int height, const DecodeOptions& options, const Run& run);

/// The codebooks shared by all levels of an ETC1S texture (KTX 2.0, section 4.1, BasisLZ).
struct Etc1sCodebooks {
  int endpoint_count = 0;
  int selector_count = 0;
  std::span<const std::uint8_t> endpoints;
  std::span<const std::uint8_t> selectors;
  std::span<const std::uint8_t> tables;
};

/// An ETC1S level, compressed with BasisLZ.
struct Etc1sLevel {
  int width = 0;
  int height = 0;
  std::span<const std::uint8_t> color;
  std::span<const std::uint8_t> alpha;  // empty without alpha
};

/// Decodes ETC1S levels to interleaved RGBA bytes.
///
/// Throws Error if a side is less than 1, if any of the data is damaged, or if `progress` cancels.
std::vector<std::vector<std::uint8_t>> decode_etc1s(const Etc1sCodebooks& codebooks,
                                                    std::span<const Etc1sLevel> levels,
                                                    const Run& run);

}  // namespace prefilter
