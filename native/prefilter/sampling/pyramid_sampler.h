// SPDX-License-Identifier: GPL-3.0-or-later

// Samples of a pyramid, many at a time (section 6.2).
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

/// What weigh_texels says of a pyramid, a table and wrap modes, worked out ahead for all places.
/// Samples are the sums of its texels but for the rounding of floats, which may also move one
/// across the border of a subdomain.
class PyramidSampler {
 public:
  /// `table` may be nullptr: trilinear interpolation. The pyramid's texels must outlive the
  /// sampler. Throws Error for a pyramid or a table that is none.
  PyramidSampler(const Pyramid& pyramid, const SamplingTable* table, const WrapModes& wrap);
  ~PyramidSampler();
  PyramidSampler(const PyramidSampler&) = delete;
  PyramidSampler& operator=(const PyramidSampler&) = delete;

  /// Writes samples at finite coordinates into `result`, channel by channel of one after another.
  /// Scales are in [0, inf): one for each, or one for all. May be called by several threads at
  /// once.
  void sample(std::span<const std::array<double, 2>> coordinates, std::span<const double> scales,
              float* result) const;

 private:
  WrappedPyramid pyramid_;
  std::unique_ptr<const TexelPlan> plan_;  // where there is a table
};

}  // namespace prefilter
