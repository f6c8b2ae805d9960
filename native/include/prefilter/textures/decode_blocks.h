// SPDX-License-Identifier: GPL-3.0-or-later

// The texels that compressed blocks stand for.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/textures/block_layout.h"
#include "prefilter/textures/compress_blocks.h"

namespace prefilter {

struct DecodeOptions {
  BlockFormat format = BlockFormat::kBc1;
  /// Whether red, green and blue are sRGB-encoded, for ASTC, whose decoders then round otherwise.
  bool is_srgb = false;
  int threads = 0;  // 0 = one per processor
};

/// The texels of blocks as compress_blocks has them: interleaved RGBA bytes, width x height of
/// them. Channels that the format lacks are 0, and an alpha 255.
///
/// Throws Error where a side is less than 1, where the number of bytes is not that of the blocks,
/// where the format is one of floats or a block of kUastc is damaged, and where `progress` cancels.
std::vector<std::uint8_t> decode_blocks(std::span<const std::uint8_t> blocks, int width, int height,
                                        const DecodeOptions& options, const Progress& progress);

/// The same for formats of floats; an alpha that the format lacks is 1.
std::vector<HalfBits> decode_half_blocks(std::span<const std::uint8_t> blocks, int width,
                                         int height, const DecodeOptions& options,
                                         const Progress& progress);

/// What all levels of a texture in ETC1S share (KTX 2.0, section 4.1, BasisLZ).
struct Etc1sCodebooks {
  int endpoint_count = 0;
  int selector_count = 0;
  std::span<const std::uint8_t> endpoints;
  std::span<const std::uint8_t> selectors;
  std::span<const std::uint8_t> tables;
};

/// A level in ETC1S, compressed by BasisLZ.
struct Etc1sLevel {
  int width = 0;
  int height = 0;
  std::span<const std::uint8_t> color;
  std::span<const std::uint8_t> alpha;  // empty where there is none
};

/// The texels of levels in ETC1S: interleaved RGBA bytes.
///
/// Throws Error where a side is less than 1, where anything is damaged, and where `progress`
/// cancels.
std::vector<std::vector<std::uint8_t>> decode_etc1s(const Etc1sCodebooks& codebooks,
                                                    std::span<const Etc1sLevel> levels,
                                                    const Progress& progress);

}  // namespace prefilter
