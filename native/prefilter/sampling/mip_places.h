// SPDX-License-Identifier: GPL-3.0-or-later

// Between which levels samples lie, many at a time.
#pragma once

namespace prefilter {

/// Of `count` scales in [0, inf), in texels of level 0: what place_between_levels says, the cell's
/// level and f, of floats. f is within 2e-7, and 1 at powers of 2.
void place_between_levels(const double* scales, int count, int levels, int* cell_levels, float* f);

}  // namespace prefilter
