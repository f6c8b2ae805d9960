// SPDX-License-Identifier: GPL-3.0-or-later

// Levels that sampling tables of any kernel fit.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"

namespace prefilter {

struct SamplingLevelsOptions {
  const Kernel* kernel = find_kernel("lanczos2");
  WrapModes wrap;
  int levels = 0;  // how many to return, with level 0; 0 = down to 1 x 1
  // False: the last of two or four channels is coverage, in [0, 1], and the others are multiplied
  // by it first. They stay so in the levels: samples are sums of what is multiplied.
  bool premultiplied = false;
  int threads = 0;  // 0 = all processors
  Progress progress;
};

/// Level k is the image filtered by the kernel, its unit a texel of the level wide, which is 2^k
/// texels of the image; half as wide and high as the one before, rounded up, so that its last
/// texels may reach beyond the image. Level 0 is the image where the kernel is 0 at all whole
/// numbers but 0, else the image filtered. Nothing is clipped.
///
/// Throws Error where channels are not 1 to 4, levels are more than the image has, memory does not
/// hold them, or a texel is not finite or beyond 1e30; and, from the progress callback, when
/// cancelled.
std::vector<Image> sampling_levels(const ImageView& image, const SamplingLevelsOptions& options);

}  // namespace prefilter
