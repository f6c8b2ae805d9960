// SPDX-License-Identifier: GPL-3.0-or-later

// What values an image has around each texel of one of another size.
#pragma once

#include <optional>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// The least and the greatest value of each channel around each texel.
struct RangesAround {
  Image low;
  Image high;
};

/// The ranges of the source texels that lie under the tent of each of width x height target texels:
/// in the square around its center of two target texels a side, or two source texels where these
/// are wider. With `alpha`, a channel that is taken for [0, 1], colors of transparent texels do not
/// count; a channel that no texel counts for has a range as wide as floats go. Of outside the image
/// there is what the wrap mode says.
RangesAround ranges_around(const TexelSource& source, std::optional<int> alpha, int width,
                           int height, WrapModes wrap, const Progress& progress, int threads);

/// Moves texels into the ranges.
void limit_to(const RangesAround& ranges, int threads, Image* image);

}  // namespace prefilter
