// SPDX-License-Identifier: GPL-3.0-or-later

// Adjusts the alpha of mipmap levels so that alpha-tested cut-outs keep their coverage.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

struct CoverageOptions {
  double threshold = 0.5;  // texels with at least this alpha are visible; above 0, at most 1
  WrapModes wrap;
  bool premultiplied = false;  // whether colors are multiplied by alpha, and must change with it
  Run run;
};

/// Returns levels 1 and up with their alpha adjusted to keep the coverage of level 0. Coverage is
/// the share of the surfaces where a bilinear lookup of alpha (the last of 4 channels, or the only
/// one) is at least the threshold. Without surfaces it is the share of the image.
///
/// Levels within 0.001 of the coverage stay as they are. In all others alpha is mapped by an
/// increasing, piecewise linear curve through (0, 0), (b, threshold) and (1, 1), with b chosen for
/// the coverage. If even the smallest b gives too little coverage, the value at 0 rises as well,
/// though not up to the threshold. Levels with few texels may only have a choice between none and
/// all; they get the closer one.
///
/// Throws Error if there is no level, if the levels do not all have 4 channels or all 1, if the
/// threshold is out of range, if an alpha above level 0 is not finite, if the surfaces have no area
/// or lie outside the image, or if the progress callback cancels.
std::vector<Image> keep_coverage(const std::vector<ImageView>& levels,
                                 const std::vector<const Surface*>& surfaces,
                                 const CoverageOptions& options);

}  // namespace prefilter
