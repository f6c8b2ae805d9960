// SPDX-License-Identifier: GPL-3.0-or-later

// Computes the levels around many samples at once.
#pragma once

namespace prefilter {

/// Computes the cell's level and f, like the scalar place_between_levels, for `count` scales in [0,
/// inf), in texels of level 0. f is accurate to 2e-7, and 1 at powers of 2.
void place_between_levels(const double* scales, int count, int levels, int* cell_levels, float* f);

}  // namespace prefilter
