// SPDX-License-Identifier: GPL-3.0-or-later

// Turns any mesh into a solid: welded, oriented, filled, thickened.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Treatment of parts that enclose no volume.
enum class SheetMethod {
  kShell,  // prisms on both sides of their faces
  kFaces,  // both sides of their faces, which voxelize must thicken
};

inline constexpr Named<SheetMethod> kSheetMethods[] = {{"shell", SheetMethod::kShell},
                                                       {"faces", SheetMethod::kFaces}};

struct SolidOptions {
  double cell = 0.0;       // side of the cells for voxelization, in the mesh's unit; above 0
  double weld = 0.05;      // in cells: maximum distance at which boundary vertices are welded
  double gap = 2.0;        // in cells: gaps up to this width do not connect to the outside
  double thickness = 1.5;  // in cells: thickness given to sheets and parts without an inside
  SheetMethod sheets = SheetMethod::kShell;
  Run run;
};

/// Statistics of as_solid.
struct SolidReport {
  std::size_t parts = 0;            // patches: faces connected by manifold edges
  std::size_t welded_vertices = 0;  // vertices replaced by another one
  std::size_t duplicate_faces = 0;  // duplicates that were dropped
  std::size_t turned_faces = 0;     // faces turned to match others of their part
  std::size_t turned_parts = 0;     // parts turned as a whole
  std::size_t thickened_parts = 0;  // parts that enclosed too little for any cell
  std::size_t filled_parts = 0;     // parts replaced by the region that the outside does not reach
};

struct Solid {
  bool is_unchanged = false;  // the mesh is a solid already; the fields below are empty then
  std::vector<Vector3> positions;
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<std::int64_t> origins;  // input triangle of each triangle, or -1
  SolidReport report;
};

/// Repairs an arbitrary triangle mesh for voxelization.
///
/// A mesh is returned unchanged if its edges are balanced (traversed as often in one direction as
/// in the other), it has no duplicate faces, and its parts are oriented outward or are cavities of
/// others. Other meshes are repaired in this order: vertices are welded, duplicate faces dropped,
/// faces oriented like their neighbors, and closed parts oriented outward.
///
/// Throws Error as voxelize does for invalid meshes, for a cell that is not positive and finite,
/// and for lengths that are negative or not finite; Error(kCancelled).
Solid as_solid(const InputMesh& mesh, const SolidOptions& options);

}  // namespace prefilter
