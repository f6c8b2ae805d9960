// SPDX-License-Identifier: GPL-3.0-or-later

// The texels of a sample and their weights, one sample at a time (section 6.2).
#pragma once

#include <array>

#include "prefilter/base/wrap.h"
#include "prefilter/sampling/pyramid.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

/// The levels around a sample.
struct MipPlace {
  int cell_level;  // the coarser level around its mip value; 0 for magnification
  int available;   // number of levels in the table's sets: the cell's and finer ones; 1 to 3
  double f;        // mip value relative to the finer level, in (0, 1]; 0 for magnification
};

/// For a filter unit of `scale` texels of level 0, in [0, inf), and the given number of levels.
MipPlace place_between_levels(double scale, int levels);

/// A coordinate equivalent to any finite `coordinate`, small enough to be counted in texels of any
/// level: in [0, 1] for kRepeat, else in [-1024, 1025].
double wrap_coordinate(double coordinate, Wrap mode);

struct WeightedTexels {
  int count = 0;
  std::array<WeightedTexel, kMaxTexels> texels;
};

/// The texels whose weighted sum is the sample at a finite (u, v), where the image spans 0 to 1.
/// From a table or, if that is nullptr, by trilinear interpolation. Weights sum to 1.
WeightedTexels weigh_texels(const Pyramid& pyramid, const SamplingTable* table,
                            const WrapModes& wrap, double u, double v, double scale);

}  // namespace prefilter
