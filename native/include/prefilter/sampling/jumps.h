// SPDX-License-Identifier: GPL-3.0-or-later

// Discontinuities of samples between the subdomains of a table.
#pragma once

#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

/// Largest discontinuity of a sample, over all images with values from 0 to 1 and all borders of
/// the section's subdomains: between subdomains, between cells, and to the next coarser level
/// (whose section has one more level, if there is one). For weights of degree 2 the borders are
/// sampled at points, otherwise the result covers them completely. If there are three levels,
/// integrals over the image use the midpoint rule.
double largest_jump(const SamplingTable& table, int levels);

}  // namespace prefilter
