// SPDX-License-Identifier: GPL-3.0-or-later

// Images of other sizes (chapter 1).
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/resize_filter.h"

namespace prefilter {

struct ResizeOptions {
  ResizeFilter filter = find_kernel("lanczos3");
  // Whether texels stay in [0, 1]: least squares are solved so, the others are clipped.
  bool constrained = false;
  // Whether texels stay within the range of the old ones around: those in a square of two new
  // texels a side, or two old ones where these are wider. Least squares are solved so, the others
  // are clipped. Colors have the range of those that are seen, before they are multiplied by alpha.
  Ringing ringing = Ringing::kAuto;
  WrapModes wrap;
  // False: the last of two or four channels is coverage, in [0, 1], and the others are not
  // multiplied by it yet. They are multiplied, filtered and divided again; colors then stay within
  // the range of those that the image shows, and alpha in [0, 1]. True: every channel is filtered
  // as it stands.
  bool premultiplied = false;
  int threads = 0;  // 0 = all processors
  Progress progress;
};

/// The image with width x height texels, from 1 to 2^20 along each side, whatever its own size. It
/// stays what it is where both are its own.
///
/// Kernels work along each axis, in units of the wider ones of old and new texels, and leave an
/// axis alone whose size stays. The box is the mean of the old texels, as squares, over the new
/// texel's square. Radial filters weigh texels by their distance, in the same units. All weights
/// are scaled to a sum of 1. Least squares minimize the integral, over the image, of the squared
/// difference between the old texels, as squares, and the new ones, interpolated bilinearly
/// (section 1.1).
///
/// Bytes are filtered by kernels with sums of floats, which is right to a few millionths, and never
/// are floats all at once; by other filters they are what floats are.
///
/// Throws Error where channels are not 1 to 4, a size is out of range, memory does not hold the
/// result, or a texel is not finite or beyond 1e30; and, from the progress callback, when
/// cancelled.
Image resize(const TexelSource& image, int width, int height, const ResizeOptions& options);

}  // namespace prefilter
