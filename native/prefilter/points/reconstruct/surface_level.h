// SPDX-License-Identifier: GPL-3.0-or-later

// Finds the value of the function at the surface.
#pragma once

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/sample_cell.h"
#include "prefilter/points/reconstruct/slabs.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// The surface is the set where the function times `scale` equals `isovalue`.
struct SurfaceLevel {
  float scale = 1.0F;
  float isovalue = 0.5F;
  bool is_reversed = false;  // the function is larger outside: a room, scanned from within
};

/// Finds the level that the options request, from the mean at the samples where needed.
/// `is_inward`: most normals point inward. Everything except the slabs' values must have been
/// computed. Throws Error(kCancelled).
SurfaceLevel find_surface_level(const ReconstructOptions& options, bool is_inward, const Run& run,
                                Slabs* slabs);

/// Weighted means over the samples of a cloud.
struct MeanSample {
  double value = 0.0;  // of the function
  Vector3 normal{};
};

/// Whether the samples show a room from within: the function, which jumps by 1 at the walls, is
/// about -1/2 there, and opposite walls cancel in the mean normal. For a single sheet such as
/// terrain the mean normal is long.
bool is_room(const MeanSample& mean);

/// The level for a mean of the function at the samples, which is negated where the function is
/// flipped. On closed surfaces the mean deviates from 1/2 as the estimated areas do; on open ones,
/// which holes bring closer to 0, as the mean over the root does.
SurfaceLevel level_of_mean(double mean, bool is_flipped, bool are_sides_known);

/// Radius around a slab that its contour requires, in octants of each depth.
inline constexpr int kContourOctants = 2;

/// The tree around slab `s` and `octants` beyond, with values times `scale`. The values of the slab
/// and its neighbors must have been computed.
CellTree tree_around(const Slabs& slabs, int s, int octants, float scale);

/// The value of the leaf that contains cell `at` of depth `depth`.
float leaf_value(const CellTree& tree, int depth, const CellPosition& at);

}  // namespace prefilter
