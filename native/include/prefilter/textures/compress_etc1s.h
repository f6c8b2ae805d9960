// SPDX-License-Identifier: GPL-3.0-or-later

// Levels compressed together as ETC1S, which loaders turn into what a device has.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/textures/block_effort.h"

namespace prefilter {

constexpr int kWorstEtc1s = 1;
constexpr int kBestEtc1s = 255;

struct Etc1sOptions {
  /// How many colors and patterns of blocks the codebooks hold, from kWorstEtc1s to kBestEtc1s.
  int quality = 192;
  /// Whether alpha is kept.
  bool has_alpha = false;
  /// Whether errors are weighed as eyes see colors; otherwise all channels count the same.
  bool is_color = true;
  BlockEffort effort = BlockEffort::kNormal;
  int threads = 0;  // 0 = one per processor
};

/// Interleaved RGBA bytes.
struct Etc1sImage {
  const std::uint8_t* rgba = nullptr;
  int width = 0;
  int height = 0;
};

/// Levels that share codebooks, as KTX 2.0 stores them (section 4.1, BasisLZ).
struct Etc1sTexture {
  struct Level {
    std::vector<std::uint8_t> color;
    std::vector<std::uint8_t> alpha;  // empty where there is none
  };

  int endpoint_count = 0;
  int selector_count = 0;
  std::vector<std::uint8_t> endpoints;
  std::vector<std::uint8_t> selectors;
  std::vector<std::uint8_t> tables;
  std::vector<Level> levels;
};

/// The levels with codebooks of their own, by Basis Universal. Blocks that reach over an edge
/// repeat the texels there. The result does not depend on the number of threads, but may on the C++
/// standard library.
///
/// Throws Error where there is no level, where a side is less than 1, where they have more than
/// 2^30 texels, where `quality` is out of range, and where `progress` cancels: between the two
/// stages, which are not interrupted.
Etc1sTexture compress_etc1s(std::span<const Etc1sImage> levels, const Etc1sOptions& options,
                            const Progress& progress);

}  // namespace prefilter
