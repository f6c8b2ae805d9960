// SPDX-License-Identifier: GPL-3.0-or-later

// Samples a pyramid at many positions (section 6.2).
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "prefilter/base/wrap.h"
#include "prefilter/sampling/sampling_table.h"
#include "prefilter/sampling/wrapped_pyramid.h"

namespace prefilter {

class TexelPlan;

/// weigh_texels with everything precomputed that depends only on the pyramid, the table and the
/// wrap modes. Samples equal the sums over its texels up to float rounding, which may also move a
/// sample across the border of a subdomain.
class PyramidSampler {
 public:
  /// If `table` is nullptr, interpolates trilinearly. The pyramid's texels must outlive the
  /// sampler. Throws Error for an invalid pyramid or table.
  PyramidSampler(const Pyramid& pyramid, const SamplingTable* table, const WrapModes& wrap);
  ~PyramidSampler();
  PyramidSampler(const PyramidSampler&) = delete;
  PyramidSampler& operator=(const PyramidSampler&) = delete;

  /// Writes samples at finite coordinates to `result`, with interleaved channels. Scales are in [0,
  /// inf): one per sample, or one for all. Thread-safe.
  void sample(std::span<const std::array<double, 2>> coordinates, std::span<const double> scales,
              float* result) const;

 private:
  WrappedPyramid pyramid_;
  std::unique_ptr<const TexelPlan> plan_;  // only with a table
};

}  // namespace prefilter
