// The indicator function in the D4 basis, as trees of values.
#pragma once

#include <vector>

#include "prefilter/reconstruct/assemble.h"
#include "prefilter/reconstruct/flux_tree.h"
#include "prefilter/reconstruct/sample_grid.h"
#include "prefilter/reconstruct/sample_slab.h"
#include "prefilter/scan/point_source.h"

namespace prefilter {

/// What the function is made of.
struct D4Samples {
  PointSource* source;
  SampleGrid grid;
  const std::vector<SampleSlab>* slabs;
  const SampleSlab* whole;                  // the levels above the slabs' first one, and this one
  const std::vector<std::size_t>* offsets;  // of the slabs' first cells in it
  int least_leaf;                           // samples whose leaves are less deep are left out
};

/// The trees of all slabs, the coarse one, and whether most normals point inward.
struct D4Function {
  std::vector<FluxTree> trees;
  CoarseTree coarse;
  bool is_flipped = false;
  double left_out = 0.0;  // the weight of what was
};

/// Reads the source once. Cells are split where they, or neighbours of theirs, hold leaves of
/// samples smaller than themselves; values are the function's at the cells' centres.
D4Function make_d4_function(const D4Samples& samples, const Progress& progress, int threads);

}  // namespace prefilter
