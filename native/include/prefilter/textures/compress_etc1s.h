// SPDX-License-Identifier: GPL-3.0-or-later

// Compresses all levels of a texture together as ETC1S, which loaders transcode to the device's
// format.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/textures/block_effort.h"

namespace prefilter {

constexpr int kMinEtc1sQuality = 1;
constexpr int kMaxEtc1sQuality = 255;

struct Etc1sOptions {
  /// Size of the codebooks of block colors and block patterns, from kMinEtc1sQuality to
  /// kMaxEtc1sQuality.
  int quality = 192;
  /// Whether to store alpha.
  bool has_alpha = false;
  /// Whether to weight errors perceptually; otherwise all channels count equally.
  bool is_color = true;
  BlockEffort effort = BlockEffort::kNormal;
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
    std::vector<std::uint8_t> alpha;  // empty without alpha
  };

  int endpoint_count = 0;
  int selector_count = 0;
  std::vector<std::uint8_t> endpoints;
  std::vector<std::uint8_t> selectors;
  std::vector<std::uint8_t> tables;
  std::vector<Level> levels;
};

/// Compresses the levels with Basis Universal, with codebooks for this texture alone. Blocks that
/// cross an edge repeat the texels there. The result is independent of the number of threads, but
/// may depend on the C++ standard library.
///
/// Throws Error if there is no level, a side is less than 1, the levels have more than 2^30 texels
/// together, `quality` is out of range, or `progress` cancels. Cancellation is only checked between
/// the two stages.
Etc1sTexture compress_etc1s(std::span<const Etc1sImage> levels, const Etc1sOptions& options,
                            const Run& run);

}  // namespace prefilter
