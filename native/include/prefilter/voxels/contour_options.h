// SPDX-License-Identifier: GPL-3.0-or-later

// Options of contours: the interpolant, the iso-value, and the source of edges.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/base/run.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

enum class Interpolant {
  kOccupancy,  // lines that preserve the occupancies of two cells: chapter 5
  kPlane,      // a surface that preserves the occupancies of neighboring cells
  kLinear,     // for samples of a smooth function: marching cubes
  kSharp,      // kPlane, with the shape's edges and corners
};

inline constexpr Named<Interpolant> kInterpolants[] = {{"occupancy", Interpolant::kOccupancy},
                                                       {"plane", Interpolant::kPlane},
                                                       {"linear", Interpolant::kLinear},
                                                       {"sharp", Interpolant::kSharp}};

/// A mesh from which a shape was made.
struct SourceMesh {
  InputMesh mesh;
  // Group of each triangle; regions of different groups are kept apart. Empty: one group.
  std::span<const std::int32_t> groups;
};

struct ContourOptions {
  // None: kSharp for octrees, kOccupancy for grids.
  std::optional<Interpolant> interpolant;
  float isovalue = 0.5F;  // samples of at least this are inside
  bool clean_up = true;   // widen narrow triangles
  // Tolerance within which larger triangles follow the full contour, in cells of the finest depth
  // along their shortest side; 0: no simplification.
  double adaptivity = 0.0;
  // Meshes from which kSharp takes edges and corners; empty: it uses the occupancies alone.
  std::span<const SourceMesh> sources;
  // Nonzero in cells of the finest depth that were thickened, where the surface differs from the
  // sources' and follows kPlane.
  const CellTree* thickened = nullptr;
  Run run;
};

}  // namespace prefilter
