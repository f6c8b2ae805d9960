// SPDX-License-Identifier: GPL-3.0-or-later

// Closes the holes of a mesh.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/base/run.h"

namespace prefilter {

enum class HoleMethod {
  kSmooth,  // a patch that continues the surface, with triangles of similar size
  kFlat,    // the triangulation of smallest area of the border's vertices
  kFan,     // triangles to the middle of the border
};

inline constexpr Named<HoleMethod> kHoleMethods[] = {
    {"smooth", HoleMethod::kSmooth}, {"flat", HoleMethod::kFlat}, {"fan", HoleMethod::kFan}};

struct CloseHolesOptions {
  HoleMethod method = HoleMethod::kSmooth;
  // Whether loops stay open if their caps would cancel the surface.
  bool leaves_losses = true;
  Run run;
};

/// Triangles that close a mesh, and the vertices that they add.
struct Caps {
  std::vector<Vector3> positions;  // numbered after the mesh's own
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::size_t open_edges = 0;  // unbalanced: traversed more often in one direction
  std::size_t holes = 0;       // loops of unbalanced edges
  std::size_t left_open = 0;   // loops left open because their caps would cancel the surface
};

/// Caps the loops of unbalanced edges, so that each edge of the result is traversed as often in one
/// direction as in the other, and winding numbers are integers. Vertices with equal positions count
/// as one.
///
/// kSmooth: the patch is refined until its triangles are as large as the border's edges (or larger
/// toward the middle, where there would be more than about 20000 points). It leaves the border
/// tangentially to the surface and bends as little as possible, so a hole in a sphere is closed by
/// the missing part. Where the surface and the area-minimizing patch meet at more than 75 degrees,
/// as around a box without a lid, the border is a crease. Holes of up to 6 edges get a fan. In
/// kFlat and kSmooth, so do loops that are traversed twice, around faces oriented against their
/// neighbors.
///
/// With `leaves_losses`, these loops stay open:
/// - the loop around a sheet, whose cap would be the reversed sheet: the part, when closed, would
/// be
///   thinner on average than 3 % of its width. Holes in the sheet smaller than a quarter of it are
///   closed;
/// - loops that other parts close already, such as borders of pieces that form a surface together:
///   the region behind the cap is inside by the mesh's winding number, and would become outside;
/// - loops whose cap would be inside out, unless the whole mesh is.
///
/// The result does not depend on the number of threads. Throws as voxelize does for invalid meshes;
/// Error(kCancelled).
Caps close_holes(const InputMesh& mesh, const CloseHolesOptions& options);

}  // namespace prefilter
