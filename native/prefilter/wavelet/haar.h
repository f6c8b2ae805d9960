// SPDX-License-Identifier: GPL-3.0-or-later

// The Haar basis on an octree (sections 3.2 and 3.2.3).
//
// On a cell, in coordinates of the unit cube, the wavelet e = ex + 2 ey + 4 ez is the product over
// the axes in e of psi (1 on the lower half, -1 on the upper one). Without the factor 2^(3j/2) of
// equation 3.4, the coefficient of f is the mean of f times the wavelet over the cell. The mean of
// an octant is the cell's plus the sum of the seven coefficients with the signs of their wavelets
// there: a Walsh-Hadamard transform of eight numbers.
#pragma once

#include "prefilter/base/run.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// In-place Walsh-Hadamard transform: v[o] becomes the sum over e of v[e], negated if e and o share
/// an odd number of bits. Applying it twice multiplies by eight.
inline void hadamard(OctantValues* values) {
  OctantValues& v = *values;
  for (const int step : {1, 2, 4}) {
    for (int i = 0; i < 8; ++i) {
      if ((i & step) != 0) continue;
      const float low = v[i];
      const float high = v[i + step];
      v[i] = low + high;
      v[i + step] = low - high;
    }
  }
}

/// Haar coefficients of an indicator function, near its boundary.
struct HaarTree {
  double mean = 0.0;  // over the root
  // A block contains the coefficients of the cell that it divides: [e] for wavelet e; [0] is
  // unused. On the last level the bits of `split` mark cells with some boundary.
  std::vector<TreeLevel> levels;
};

/// Computes the cell means of an indicator function from its coefficients, down to `depth` (-1:
/// all). For closed surfaces, cells without boundary have the exact value 0 or 1, as rounding
/// errors up to 1e-5 are removed. Where surfaces overlap or are inverted, the winding number
/// differs from 0 and 1; values are clamped to [0, 1], so that overlaps count once.
CellTree synthesise(HaarTree coefficients, int depth, const Run& run);

}  // namespace prefilter
