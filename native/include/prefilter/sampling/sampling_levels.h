// SPDX-License-Identifier: GPL-3.0-or-later

// Filtered levels of an image for sampling tables of any kernel.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"

namespace prefilter {

struct SamplingLevelsOptions {
  const Kernel* kernel = find_kernel("lanczos2");
  WrapModes wrap;
  int levels = 0;  // number of levels to return, including level 0; 0 = down to 1 x 1
  // False: the last of two or four channels is coverage in [0, 1]; the others are multiplied by it
  // first. The levels are premultiplied, as samples are sums of premultiplied texels.
  bool premultiplied = false;
  Run run;
};

/// Level k is the image filtered by the kernel with a unit of one texel of the level, 2^k texels of
/// the image. Its sides are half the previous ones, rounded up, so its last texels may extend
/// beyond the image. Level 0 is the image itself if the kernel is 0 at all integers but 0, else the
/// filtered image. Values are not clipped.
///
/// Throws Error if the channel count is not 1 to 4, more levels are requested than the image has,
/// they exceed the memory, or a texel is not finite or beyond 1e30; and, from the progress
/// callback, when cancelled.
std::vector<Image> sampling_levels(const ImageView& image, const SamplingLevelsOptions& options);

}  // namespace prefilter
