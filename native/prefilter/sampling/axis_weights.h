// SPDX-License-Identifier: GPL-3.0-or-later

// What a kernel of any width weighs the texels of an axis with, once it is wrapped.
#pragma once

#include <vector>

#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"

namespace prefilter {

/// Texels of an axis, all different, and their weights. With the wrap mode border those of texels
/// outside are lost; else they sum to 1.
struct AxisWeights {
  std::vector<int> texels;
  std::vector<double> weights;
};

/// The taps of the kernel at `center`, in texels from the axis' low end, its unit `width` texels
/// wide, 1 or more: kernel_taps, those that read the same texel added up. As many as the axis has
/// texels at the most, and found in time that is proportional to them, whatever the width.
AxisWeights axis_weights(const Kernel& kernel, double center, double width, int size, Wrap mode);

}  // namespace prefilter
