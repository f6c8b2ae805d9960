// SPDX-License-Identifier: GPL-3.0-or-later

// Resizes images (chapter 1).
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/resize_filter.h"

namespace prefilter {

struct ResizeOptions {
  ResizeFilter filter = find_kernel("lanczos3");
  // Whether texels must stay in [0, 1]. Least squares is solved with this constraint, other results
  // are clipped.
  bool constrained = false;
  // Whether texels must stay within the range of nearby source texels: those in a square with a
  // side of two target texels, or two source texels if these are wider. Least squares is solved
  // with this constraint, other results are clipped. The range of colors is that of visible texels,
  // before multiplication by alpha.
  Ringing ringing = Ringing::kAuto;
  WrapModes wrap;
  // False: the last of two or four channels is coverage in [0, 1], and the others are not yet
  // multiplied by it. They are multiplied, filtered and divided again. Colors then stay within the
  // range of the visible ones, and alpha in [0, 1]. True: every channel is filtered independently.
  bool premultiplied = false;
  Run run;
};

/// Resizes the image to width x height texels, 1 to 2^20 along each side. An image of the same size
/// is returned unchanged.
///
/// Kernels are applied along each axis, in units of the larger of source and target texels; an axis
/// whose size does not change is not filtered. The box is the mean of the source texels, as
/// squares, over the target texel's square. Radial filters weight texels by distance, in the same
/// units. All weights are normalized. Least squares minimizes the integral, over the image, of the
/// squared difference between the source texels, as squares, and the bilinearly interpolated target
/// texels (section 1.1).
///
/// Kernels filter bytes with float sums, accurate to a few millionths, without converting the whole
/// image to floats; other filters convert them first.
///
/// Throws Error if the channel count is not 1 to 4, a size is out of range, the result exceeds the
/// memory, or a texel is not finite or beyond 1e30; and, from the progress callback, when
/// cancelled.
Image resize(const TexelSource& image, int width, int height, const ResizeOptions& options);

}  // namespace prefilter
