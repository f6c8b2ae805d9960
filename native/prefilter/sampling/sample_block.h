// SPDX-License-Identifier: GPL-3.0-or-later

// Blocks of samples that are processed together, step by step.
#pragma once

#include <array>
#include <cstdint>

#include "prefilter/sampling/pairs.h"
#include "prefilter/sampling/texel_plan.h"
#include "prefilter/sampling/wrapped_pyramid.h"

namespace prefilter {

inline constexpr int kBlockSamples = 128;

struct SampleBlock {
  int count = 0;
  std::array<Pair, kBlockSamples> coordinates;  // as wrap_coordinate returns them
  std::array<int, kBlockSamples> cell_levels;   // see MipPlace
  std::array<float, kBlockSamples> f;
};

/// Indices of samples in a block.
struct SampleList {
  int count = 0;
  std::array<std::int16_t, kBlockSamples> numbers;

  /// Adds an index if `is_member`, without a branch.
  void add(int number, bool is_member) {
    numbers[count] = static_cast<std::int16_t>(number);
    count += static_cast<int>(is_member);
  }
};

/// Writes the samples of a block, using the table of the plan.
void sample_block(const TexelPlan& plan, const WrappedPyramid& pyramid, const SampleBlock& block,
                  float* result);

/// The same with trilinear interpolation.
void sample_block_trilinearly(const WrappedPyramid& pyramid, const SampleBlock& block,
                              float* result);

}  // namespace prefilter
