// SPDX-License-Identifier: GPL-3.0-or-later

// Any mesh as one that has an inside: welded, turned, filled, thickened.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// What becomes of parts that enclose nothing.
enum class SheetMethod {
  kShell,  // prisms on both sides of their faces
  kFaces,  // their faces, from both sides: nothing until voxelize thickens it
};

inline constexpr Named<SheetMethod> kSheetMethods[] = {{"shell", SheetMethod::kShell},
                                                       {"faces", SheetMethod::kFaces}};

struct SolidOptions {
  double cell = 0.0;   // the side of the cells that it is voxelized in, in the mesh's unit; above 0
  double weld = 0.05;  // in cells: vertices along open edges count as one up to this distance
  double gap = 2.0;    // in cells: gaps up to this width do not let the outside in
  double thickness = 1.5;  // in cells: what sheets and parts without an inside get
  SheetMethod sheets = SheetMethod::kShell;
  int threads = 0;  // 0: all processors
  Progress progress;
};

/// What as_solid did.
struct SolidReport {
  std::size_t parts = 0;            // patches: faces that hang together by edges of two
  std::size_t welded_vertices = 0;  // that count as another one
  std::size_t duplicate_faces = 0;  // that were there before, and were dropped
  std::size_t turned_faces = 0;     // against others of their part
  std::size_t turned_parts = 0;     // as a whole
  std::size_t thickened_parts = 0;  // that had no inside, or too little of it for any cell
  std::size_t filled_parts = 0;     // whose inside is what the outside does not reach
};

struct Solid {
  bool is_unchanged = false;  // the mesh is a solid as it is; what follows is empty then
  std::vector<Vector3> positions;
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<std::int64_t> origins;  // of each triangle: that which it came from, or -1
  SolidReport report;
};

/// A mesh that voxelize makes a good solid of, from any triangles.
///
/// A mesh whose edges are all run through as often one way as the other, which holds no face twice
/// and whose parts are right side out or cavities in others is unchanged. Others get, in this
/// order: vertices that count as one, each face once, faces turned to go with their neighbors,
/// closed parts turned right side out.
///
/// Throws Error as voxelize does for a mesh that is no mesh; for a cell that is not finite and
/// above 0, and lengths that are negative or not finite; Error(kCancelled).
Solid as_solid(const InputMesh& mesh, const SolidOptions& options);

}  // namespace prefilter
