// SPDX-License-Identifier: GPL-3.0-or-later

// Weights of the texels along an axis for a kernel of any width, after wrapping.
#pragma once

#include <vector>

#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"

namespace prefilter {

/// Distinct texels of an axis, and their weights. They sum to 1, except that in the border mode the
/// weights of texels outside are missing.
struct AxisWeights {
  std::vector<int> texels;
  std::vector<double> weights;
};

/// The kernel_taps at `center`, in texels from the low end of the axis, for a unit of `width`
/// texels, at least 1. Taps of the same texel are merged. There are at most as many as the axis has
/// texels, and the time is proportional to their number for any width.
AxisWeights axis_weights(const Kernel& kernel, double center, double width, int size, Wrap mode);

}  // namespace prefilter
