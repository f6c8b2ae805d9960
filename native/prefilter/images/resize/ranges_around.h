// SPDX-License-Identifier: GPL-3.0-or-later

// Ranges of the values around each texel of a resized image.
#pragma once

#include <optional>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// The minimum and maximum of each channel around each texel.
struct RangesAround {
  Image low;
  Image high;
};

/// The ranges of the source texels under the tent of each of width x height target texels: in a
/// square around its center with a side of two target texels, or two source texels if these are
/// wider. If there is a channel `alpha`, its own range is [0, 1], and colors of transparent texels
/// do not count. Channels without any texel that counts are unlimited. The wrap mode defines the
/// texels outside the image.
RangesAround ranges_around(const TexelSource& source, std::optional<int> alpha, int width,
                           int height, WrapModes wrap, const Run& run);

/// Clamps texels to the ranges.
void limit_to(const RangesAround& ranges, int threads, Image* image);

}  // namespace prefilter
