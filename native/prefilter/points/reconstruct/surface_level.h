// SPDX-License-Identifier: GPL-3.0-or-later

// At which value of the function the surface is.
#pragma once

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/sample_cell.h"
#include "prefilter/points/reconstruct/slabs.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// The surface is where the function times `scale` is `isovalue`.
struct SurfaceLevel {
  float scale = 1.0F;
  float isovalue = 0.5F;
  bool is_reversed = false;  // the outside is where the function is larger: a room, from within
};

/// As the options say, from the mean at the samples where that counts; `is_inward`: most normals
/// point inward. Slabs have got all but their values. Throws Error(kCancelled).
SurfaceLevel find_surface_level(const ReconstructOptions& options, bool is_inward,
                                const Progress& progress, Slabs* slabs);

/// What the samples of a cloud have in the mean, by their weight.
struct MeanSample {
  double value = 0.0;  // of the function
  Vector3 normal{};
};

/// Whether samples are of a room, seen from within: the function, which jumps by 1 at its walls, is
/// about -1/2 there, and walls that face each other leave nothing of the mean normal. Of one sheet,
/// as a terrain, much of that is left.
bool is_room(const MeanSample& mean);

/// The level that follows from the mean of the function, times -1 where it is flipped, at the
/// samples. Of a closed surface the mean is off from 1/2 as the areas are; of an open one, as the
/// mean over the root is, to which its holes leave much.
SurfaceLevel level_of_mean(double mean, bool is_flipped, bool are_sides_known);

/// Around a slab, in octants of any depth: what its contour needs.
inline constexpr int kContourOctants = 2;

/// The tree around slab `s`, and so many octants beyond, of values times `scale`.
/// The values of the slab and of those next to it have been made.
CellTree tree_around(const Slabs& slabs, int s, int octants, float scale);

/// The value of the leaf that holds a cell of depth `depth`.
float leaf_value(const CellTree& tree, int depth, const CellPosition& at);

}  // namespace prefilter
