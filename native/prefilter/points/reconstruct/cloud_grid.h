// SPDX-License-Identifier: GPL-3.0-or-later

// The grid of cells into which a cloud's samples are sorted.
#pragma once

#include "prefilter/base/geometry.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/automatic_depth.h"
#include "prefilter/points/reconstruct/gather_samples.h"
#include "prefilter/points/reconstruct/sample_grid.h"

namespace prefilter {

/// The grid around a box, at the depth that the options request; otherwise the depth follows from
/// the density of the points in `thinned`. Throws Error where the box is too large or cells would
/// be too small.
SampleGrid grid_of(const Box& box, const ThinnedPoints& thinned, const ReconstructOptions& options);

/// Writes the cloud's point counts and the grid's size to the report.
void describe_grid(const SampleGrid& grid, const CloudExtent& extent, ReconstructReport* report);

}  // namespace prefilter
