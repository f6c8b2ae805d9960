// SPDX-License-Identifier: GPL-3.0-or-later

// The indicator function in the D4 basis, as trees of values.
#pragma once

#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct/assemble.h"
#include "prefilter/points/reconstruct/flux_tree.h"
#include "prefilter/points/reconstruct/sample_grid.h"
#include "prefilter/points/reconstruct/slabs.h"

namespace prefilter {

/// The trees of all slabs, the coarse one, and whether most normals point inward.
struct D4Function {
  std::vector<FluxTree> trees;
  CoarseTree coarse;
  bool is_flipped = false;
  double left_out = 0.0;  // the weight of what was
};

/// Of slabs that are all at SlabStage::kLeaves. Reads the source once. Cells are split where they,
/// or neighbors of theirs, hold leaves of samples smaller than themselves; values are the
/// function's at the cells' centers.
D4Function make_d4_function(PointSource* source, const SampleGrid& grid, const Slabs& slabs,
                            const Progress& progress, int threads);

}  // namespace prefilter
