// SPDX-License-Identifier: GPL-3.0-or-later

// Resizing by least squares for bilinear interpolation.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/resize/ranges_around.h"

namespace prefilter {

/// The image c of width x height texels that minimizes, within the ranges of `solve`,
///   integral over the image of (I(x) - sum_i c_i b_i(x))^2 dx
/// where I are the source's texels as squares, and b_i are the tents that interpolate c bilinearly,
/// wrapped around the image as the wrap mode says (section 1.1 with the bilinear basis). With
/// clamp, the outermost texels reach out to the image's edge; with border there are zeros around
/// them. With ranges_times_alpha the last channel is alpha. `around`, where it is given, has ranges
/// for each texel, within which it stays too; with ranges_times_alpha, of colors before they are
/// multiplied.
Image fit_bilinearly(const ImageView& source, int width, int height, WrapModes wrap,
                     const SolveOptions& solve, const RangesAround* around,
                     const Progress& progress);

}  // namespace prefilter
