// SPDX-License-Identifier: GPL-3.0-or-later

// Checks samples of grids in the plane and in space.
#pragma once

#include <cmath>
#include <span>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Maximum number of samples along an axis.
inline constexpr int kLargestSide = 1 << kMaxTreeDepth;

/// Throws Error if a grid has no samples, or too many, along an axis.
inline void check_sides(std::span<const int> sizes) {
  for (std::size_t a = 0; a < sizes.size(); ++a) {
    if (sizes[a] >= 1 && sizes[a] <= kLargestSide) continue;
    throw_invalid("grid: " + std::to_string(sizes[a]) + " cells along " + std::string(1, "xyz"[a]) +
                  "; 1 to " + std::to_string(kLargestSide) + " are needed");
  }
}

/// Throws Error if a sample is not finite.
inline void check_samples(std::span<const float> samples) {
  for (const float sample : samples) {
    if (std::isfinite(sample)) continue;
    throw_invalid("grid: holds " + to_text(static_cast<double>(sample)) +
                  "; all samples must be finite");
  }
}

}  // namespace prefilter
