// SPDX-License-Identifier: GPL-3.0-or-later

// A tree's values changed so that its contour follows the samples.
//
// Beyond the text: the function that was solved for knows the surface to a twentieth of a cell or
// so, samples that agree know it better. Vertices that are moved onto these one by one fold the
// surface where they are close to each other. The contour of a function between the centers of
// cells hardly folds, whatever its values are; so it is the values that are changed.
#pragma once

#include "prefilter/points/reconstruct/fit_samples.h"
#include "prefilter/voxels/contour/height_range.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Where values are changed, in cells of the tree's depth.
struct FitRange {
  HeightRange heights;  // of the contour that is to follow the samples
  int largest = 1;      // the side of a leaf: larger ones keep their values
};

/// What a leaf's new value follows from, in octants of its depth.
inline constexpr int kFitOctants = 12;

/// Changes the values of leaves that the contour at these heights is made of. Of a leaf that counts
/// at other heights as well it makes the same there. The tree, and the samples of `fit`, are known
/// as many octants above and below the heights as is said above.
void fit_values(const SampleFit& fit, float isovalue, const FitRange& range, CellTree* tree);

}  // namespace prefilter
