// SPDX-License-Identifier: GPL-3.0-or-later

// Options of contours: the interpolant, the iso-value, and what they keep the edges of.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/base/progress.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

enum class Interpolant {
  kOccupancy,  // a line that leaves each of two cells its share: chapter 5
  kPlane,      // the surface that preserves neighboring cells
  kLinear,     // samples of a smooth function: marching cubes
  kSharp,      // kPlane, with the edges and corners of the shape
};

inline constexpr Named<Interpolant> kInterpolants[] = {{"occupancy", Interpolant::kOccupancy},
                                                       {"plane", Interpolant::kPlane},
                                                       {"linear", Interpolant::kLinear},
                                                       {"sharp", Interpolant::kSharp}};

/// A mesh that a shape was made of.
struct SourceMesh {
  InputMesh mesh;
  // Of each triangle; those of different groups are kept apart. None: all are of one.
  std::span<const std::int32_t> groups;
};

struct ContourOptions {
  // None: kSharp of octrees, and kOccupancy of grids.
  std::optional<Interpolant> interpolant;
  float isovalue = 0.5F;  // samples of at least this are inside
  bool clean_up = true;   // widen narrow triangles
  // How far a surface may be from the full contour where it gets larger triangles, in cells of the
  // finest depth, along their shortest side; 0: it is the full one.
  double adaptivity = 0.0;
  // What kSharp takes the edges and corners from; none: from the occupancies alone.
  std::span<const SourceMesh> sources;
  // Above 0 in the cells of the finest depth where the surface is not that of the sources, as they
  // are thin there: it is kPlane's.
  const CellTree* thickened = nullptr;
  int threads = 0;  // 0: all processors
  Progress progress;
};

}  // namespace prefilter
