// SPDX-License-Identifier: GPL-3.0-or-later

// Checks the inputs and results of reconstructions; messages state the allowed values.
#pragma once

#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/gather_samples.h"

namespace prefilter {

/// Throws Error for options out of range.
void check_options(const ReconstructOptions& options);
/// Throws Error for clouds of fewer than 3 valid points, or whose points all coincide.
void check_cloud(const CloudExtent& extent);
/// Throws Error for a mesh without triangles.
void check_mesh(const ReconstructOptions& options, const ReconstructReport& report);

}  // namespace prefilter
