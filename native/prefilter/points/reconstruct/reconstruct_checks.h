// SPDX-License-Identifier: GPL-3.0-or-later

// What reconstructions refuse, with messages that say what is needed.
#pragma once

#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/gather_samples.h"

namespace prefilter {

/// Throws Error for options out of range.
void check_options(const ReconstructOptions& options);
/// Throws Error for clouds of fewer than 3 points, or that all coincide.
void check_cloud(const CloudExtent& extent);
/// Throws Error for a mesh of no triangle, which helps nobody.
void check_mesh(const ReconstructOptions& options, const ReconstructReport& report);

}  // namespace prefilter
