// SPDX-License-Identifier: GPL-3.0-or-later

// Haar coefficients of sampled surfaces (section 4.2), for cells between two depths.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/reconstruct/sample_slab.h"
#include "prefilter/wavelet/boundary_flux.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// The sampled surface in a cell.
struct CellFlux {
  std::uint64_t place = 0;  // along the Morton curve of the cell's depth
  BoundaryFlux flux;
  bool is_split = false;
};

/// Blocks of one depth of a part of a tree, along the Morton curve.
struct NodeLevel {
  std::vector<std::uint64_t> places;  // of the cells that they split
  TreeLevel blocks;                   // `first` counts within the part
};

/// Levels of a tree from depth `top` on: its coefficients, or its values.
struct FluxTree {
  int top = 0;
  std::vector<NodeLevel> levels;
  std::vector<CellFlux> tops;  // the cells of depth `top`
};

/// What samples give the cells of their leaves: at [k] those of depth k, in no order.
using PooledFlux = std::vector<std::vector<CellFlux>>;

/// Adds what the samples of a slab give, but for those of which add_patches takes the planes.
/// `whole` has the levels from depth 0 to the slab's first one, whose cells begin there at
/// `offset`. Samples whose leaves are less deep than `least_leaf`, as those of outliers are, are
/// left out; returns their weight.
double pool_flux(const SampleSlab& slab, const SampleSlab& whole, std::size_t offset,
                 int least_leaf, PooledFlux* pooled);

/// The coefficients of all cells between two depths that hold leaves of samples smaller than
/// themselves, as triangle_analysis.h has them; `split` tells the octants that have some, too.
FluxTree analyze_flux(PooledFlux pooled, int top, int depth);

/// Coefficients to values, for parts whose first cells have these.
void synthesise_part(const std::vector<float>& tops, FluxTree* tree);

}  // namespace prefilter
