// SPDX-License-Identifier: GPL-3.0-or-later

// What smoothing takes from thin parts, given back.
//
// Beyond the text: of a plate a cell thick smoothing leaves half, of a rod a quarter. What is less
// than the iso-value is no surface, and no line across it is left for values to be fitted to. Thin
// parts are where the samples of opposite sides are close together.
#pragma once

#include "prefilter/points/reconstruct/fit_samples.h"
#include "prefilter/points/reconstruct/fit_values.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Changes the values of leaves around samples. The mean samples in and around a leaf say how far
/// the function is off the iso-value at them: its value changes by as much as that is to be
/// trusted, and by all of it where the normals around cancel each other. The range, and what is
/// known beyond it, are as for fit_values.
void restore_thin_parts(const SampleFit& fit, float isovalue, const FitRange& range,
                        CellTree* tree);

}  // namespace prefilter
