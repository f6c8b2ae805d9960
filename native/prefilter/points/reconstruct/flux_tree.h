// SPDX-License-Identifier: GPL-3.0-or-later

// Haar coefficients of sampled surfaces (section 4.2), for cells between two depths.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/points/reconstruct/sample_slab.h"
#include "prefilter/wavelet/boundary_flux.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// How much of the surface the samples of a cell stand for, and where they are: in coordinates that
/// make the cell the unit cube.
struct SampledArea {
  float area = 0.0F;
  std::array<float, 3> moment{};  // of the samples' positions

  void add(const SampledArea& other) {
    area += other.area;
    for (std::size_t a = 0; a < 3; ++a) moment[a] += other.moment[a];
  }
};

/// The sampled surface in a cell.
struct CellFlux {
  std::uint64_t place = 0;  // along the Morton curve of the cell's depth
  BoundaryFlux flux;
  SampledArea sampled;
  bool is_split = false;
};

/// The same of an octant of a block.
struct OctantFlux {
  std::array<float, 3> area{};
  std::array<float, 3> moment{};
  SampledArea sampled;
};

/// Blocks of one depth of a part of a tree, along the Morton curve.
struct NodeLevel {
  std::vector<std::uint64_t> places;  // of the cells that they split
  TreeLevel blocks;                   // `first` counts within the part
  std::vector<OctantValues> solved;   // values after the solve; none before
  // Of the octants that have some, block by block; a block's bits tell which.
  std::vector<OctantFlux> fluxes;
  std::vector<std::uint8_t> has_flux;
  std::vector<std::uint32_t> first_flux;

  /// Null where there is none.
  const OctantFlux* flux(std::size_t block, int octant) const {
    if (has_flux.empty() || ((has_flux[block] >> octant) & 1U) == 0U) return nullptr;
    const unsigned before = has_flux[block] & ((1U << octant) - 1U);
    return &fluxes[first_flux[block] + static_cast<std::size_t>(std::popcount(before))];
  }
};

/// Levels of a tree from depth `top` on: its coefficients, or its values.
struct FluxTree {
  int top = 0;
  std::vector<NodeLevel> levels;
  std::vector<CellFlux> tops;  // the cells of depth `top`
};

/// What samples give the cells of their leaves: at [k] those of depth k, in no order.
using PooledFlux = std::vector<std::vector<CellFlux>>;

/// The coefficients of all cells between two depths that hold leaves of samples smaller than
/// themselves, as triangle_analysis.h has them; `split` tells the octants that have some, too.
FluxTree analyze_flux(PooledFlux pooled, int top, int depth);

/// Coefficients to values, for parts whose first cells have these.
void synthesise_part(const std::vector<float>& tops, FluxTree* tree);

}  // namespace prefilter
