// SPDX-License-Identifier: GPL-3.0-or-later

// The indicator function in the D4 basis, as octrees of values.
#pragma once

#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct/assemble.h"
#include "prefilter/points/reconstruct/flux_tree.h"
#include "prefilter/points/reconstruct/sample_grid.h"
#include "prefilter/points/reconstruct/slabs.h"

namespace prefilter {

/// The trees of all slabs, the coarse tree above them, and whether most normals point inward.
struct D4Function {
  std::vector<FluxTree> trees;
  CoarseTree coarse;
  bool is_flipped = false;
  double left_out = 0.0;  // total weight of the outliers
};

/// Evaluates the function for slabs that are all at SlabStage::kLeaves; reads the source once. A
/// cell is split where it or a neighbor contains sample leaves smaller than itself. Values are
/// those at cell centers.
D4Function make_d4_function(PointSource* source, const SampleGrid& grid, const Slabs& slabs,
                            const Run& run);

}  // namespace prefilter
