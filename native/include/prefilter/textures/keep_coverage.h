// SPDX-License-Identifier: GPL-3.0-or-later

// Levels of alpha-tested cut-outs that show as much of the surface as the image does.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

struct CoverageOptions {
  double threshold = 0.5;  // the alpha that is still shown; above 0, at most 1
  WrapModes wrap;
  bool premultiplied = false;  // whether colors are multiplied by alpha, and change along with it
  int threads = 0;             // 0 = all processors
  Progress progress;
};

/// Levels 1 and up of those given, with an alpha test that keeps the share of the surfaces that the
/// one of level 0 keeps: the share where a bilinear lookup's alpha, the last of 4 channels or the
/// only one, is at least the threshold. Without a surface it is the share of the image.
///
/// A level that has it within 0.001 stays as it is. Else its alpha is mapped by a curve that rises,
/// of two straight pieces: from (0, 0) to (b, threshold) to (1, 1), with the b that gives the
/// share. Where even the smallest b shows too little, 0 rises as well, though not to the threshold.
/// Levels of few texels may have to show all or nothing; they get as close as they can.
///
/// Throws Error where there is no level, their channels are not all 4 or all 1, the threshold is
/// out of range, alpha is not finite in a level above 0, or surfaces are given that have no area or
/// lie outside of the image; and, from the progress callback, when cancelled.
std::vector<Image> keep_coverage(const std::vector<ImageView>& levels,
                                 const std::vector<const Surface*>& surfaces,
                                 const CoverageOptions& options);

}  // namespace prefilter
