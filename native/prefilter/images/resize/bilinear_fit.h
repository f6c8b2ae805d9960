// SPDX-License-Identifier: GPL-3.0-or-later

// Least-squares resizing for bilinear interpolation.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/resize/ranges_around.h"

namespace prefilter {

/// The image c of width x height texels that minimizes, within the ranges of `solve`,
///   integral over the image of (I(x) - sum_i c_i b_i(x))^2 dx
/// where I are the source's texels as squares, and b_i are the tents that interpolate c bilinearly,
/// wrapped around the image by the wrap mode (section 1.1 with the bilinear basis). In clamp mode
/// the outermost texels extend to the image's edge; in border mode they are surrounded by zeros. If
/// ranges_times_alpha is set, the last channel is alpha. `around`, if not null, further restricts
/// each texel to its own range; if ranges_times_alpha is set, that is the range of colors before
/// multiplication.
Image fit_bilinearly(const ImageView& source, int width, int height, WrapModes wrap,
                     const SolveOptions& solve, const RangesAround* around, const Run& run);

}  // namespace prefilter
