// SPDX-License-Identifier: GPL-3.0-or-later

// Restores thin parts that smoothing weakens.
//
// Not in the dissertation: smoothing leaves half of a plate one cell thick, and a quarter of a rod.
// Below the iso-value there is no surface, and so no line across it to which values could be
// fitted. Thin parts are recognized by samples of opposite sides that are close together.
#pragma once

#include "prefilter/points/reconstruct/fit_samples.h"
#include "prefilter/points/reconstruct/fit_values.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Changes the values of leaves around samples, by the difference between the iso-value and the
/// function at the mean samples in and around each leaf. The change is weighted by the samples'
/// trust, and applied in full where the normals around cancel each other. Ranges and margins are
/// those of fit_values.
void restore_thin_parts(const SampleFit& fit, float isovalue, const FitRange& range,
                        CellTree* tree);

}  // namespace prefilter
