// SPDX-License-Identifier: GPL-3.0-or-later

// Adjusts the values of a tree so that its contour follows the samples.
//
// Not in the dissertation: the solved function locates the surface to about 1/20 of a cell, while
// consistent samples locate it more precisely. Moving contour vertices onto them individually folds
// the surface where vertices are close together. The contour of a function interpolated between
// cell centers hardly folds, so the values are adjusted instead.
#pragma once

#include "prefilter/points/reconstruct/fit_samples.h"
#include "prefilter/voxels/contour/height_range.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// The range in which values are adjusted, in cells of the tree's depth.
struct FitRange {
  HeightRange heights;  // heights of the contour that shall follow the samples
  int largest = 1;      // side of the largest leaf that is adjusted
};

/// Radius, in octants of a leaf's depth, of the data on which its new value depends.
inline constexpr int kFitOctants = 12;

/// Adjusts the values of the leaves that affect the contour at the given heights. Leaves that also
/// affect other heights get the same values when those are fitted. The tree and the samples of
/// `fit` must be known for kFitOctants octants above and below the heights.
void fit_values(const SampleFit& fit, float isovalue, const FitRange& range, CellTree* tree);

}  // namespace prefilter
