// SPDX-License-Identifier: GPL-3.0-or-later

// The cells that a cloud is put into: how many, and where.
#pragma once

#include "prefilter/base/geometry.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/carried_depth.h"
#include "prefilter/points/reconstruct/gather_samples.h"
#include "prefilter/points/reconstruct/sample_grid.h"

namespace prefilter {

/// Around a box, as deep as the options say; `some` of the points tell it where these do not.
/// Throws Error where the box is too large or cells would be too small.
SampleGrid grid_of(const Box& box, const ThinnedPoints& some, const ReconstructOptions& options);

/// Says how many points there were, and what they were put into.
void describe_grid(const SampleGrid& grid, const CloudExtent& extent, ReconstructReport* report);

}  // namespace prefilter
