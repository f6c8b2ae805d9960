// SPDX-License-Identifier: GPL-3.0-or-later

// Haar coefficients of sampled surfaces (section 4.2), for the cells between two depths.
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

/// Surface area that the samples of a cell represent, and its first moment, in coordinates in which
/// the cell is the unit cube.
struct SampledArea {
  float area = 0.0F;
  std::array<float, 3> moment{};  // area times mean sample position

  void add(const SampledArea& other) {
    area += other.area;
    for (std::size_t a = 0; a < 3; ++a) moment[a] += other.moment[a];
  }
};

/// The sampled surface in one cell.
struct CellFlux {
  std::uint64_t place = 0;  // Morton index at the cell's depth
  BoundaryFlux flux;
  SampledArea sampled;
  bool is_split = false;
};

/// The sampled surface in one octant of a block, in single precision.
struct OctantFlux {
  std::array<float, 3> area{};
  std::array<float, 3> moment{};
  SampledArea sampled;
};

/// Blocks of one depth in a part of a tree, along the Morton curve.
struct NodeLevel {
  std::vector<std::uint64_t> places;  // Morton indices of the cells that they split
  TreeLevel blocks;                   // `first` indexes the next level of the same part
  std::vector<OctantValues> solved;   // values after the solve; empty before
  // Fluxes of the octants that have one, block by block; the bits of `has_flux` select the octants.
  std::vector<OctantFlux> fluxes;
  std::vector<std::uint8_t> has_flux;
  std::vector<std::uint32_t> first_flux;

  /// Null where the octant has no flux.
  const OctantFlux* flux(std::size_t block, int octant) const {
    if (has_flux.empty() || ((has_flux[block] >> octant) & 1U) == 0U) return nullptr;
    const unsigned before = has_flux[block] & ((1U << octant) - 1U);
    return &fluxes[first_flux[block] + static_cast<std::size_t>(std::popcount(before))];
  }
};

/// Levels of a tree from depth `top` down, holding coefficients or values.
struct FluxTree {
  int top = 0;
  std::vector<NodeLevel> levels;
  std::vector<CellFlux> tops;  // the cells of depth `top`
};

/// Contributions of the samples to the cells of their leaves: element k holds those of depth k,
/// unsorted.
using PooledFlux = std::vector<std::vector<CellFlux>>;

/// Computes the coefficients of all cells between two depths that contain sample leaves smaller
/// than themselves (see triangle_analysis.h). Octants that have coefficients of their own are
/// marked in `split`.
FluxTree analyze_flux(PooledFlux pooled, int top, int depth);

/// Converts coefficients to values in place, given the values of the part's first cells.
void synthesize_part(const std::vector<float>& tops, FluxTree* tree);

}  // namespace prefilter
