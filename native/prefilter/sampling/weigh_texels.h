// SPDX-License-Identifier: GPL-3.0-or-later

// Which texels make up a sample, one sample at a time (section 6.2).
#pragma once

#include <array>

#include "prefilter/base/wrap.h"
#include "prefilter/sampling/pyramid.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

/// Between which levels a sample lies.
struct MipPlace {
  int cell_level;  // the coarser one of the two around its mip value; 0 where it magnifies
  int available;   // levels that a table has texels of: the cell's, and finer ones; 1 to 3
  double f;        // mip value above the finer one of the two, in (0, 1]; 0 where it magnifies
};

/// For a filter whose unit is `scale`, in [0, inf), texels of level 0 wide, and this many levels.
MipPlace place_between_levels(double scale, int levels);

/// A coordinate that reads what `coordinate`, any finite one, does, small enough to be counted in
/// texels of any level: for kRepeat in [0, 1], else in [-1024, 1025].
double wrap_coordinate(double coordinate, Wrap mode);

struct WeightedTexels {
  int count = 0;
  std::array<WeightedTexel, kMostTexels> texels;
};

/// The texels whose weighted sum is the sample at (u, v), finite, with the image from 0 to 1 along
/// both; by a table, or for nullptr by trilinear interpolation. Weights sum to 1.
WeightedTexels weigh_texels(const Pyramid& pyramid, const SamplingTable* table,
                            const WrapModes& wrap, double u, double v, double scale);

}  // namespace prefilter
