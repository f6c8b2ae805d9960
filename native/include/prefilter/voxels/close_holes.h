// SPDX-License-Identifier: GPL-3.0-or-later

// Caps for the holes of a mesh.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/base/progress.h"

namespace prefilter {

enum class HoleMethod {
  kSmooth,  // a patch that continues the surface, with triangles like those around
  kFlat,    // the triangles of the smallest area between the vertices of the border
  kFan,     // triangles to the middle of the border
};

inline constexpr Named<HoleMethod> kHoleMethods[] = {
    {"smooth", HoleMethod::kSmooth}, {"flat", HoleMethod::kFlat}, {"fan", HoleMethod::kFan}};

struct CloseHolesOptions {
  HoleMethod method = HoleMethod::kSmooth;
  // Whether those loops stay open whose caps would cancel the surface.
  bool leaves_losses = true;
  int threads = 0;  // 0: all processors
  Progress progress;
};

/// Triangles that close a mesh, and the vertices that they need.
struct Caps {
  std::vector<Vector3> positions;  // numbered on from the mesh's own
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::size_t open_edges = 0;  // unbalanced: traversed more often in one direction
  std::size_t holes = 0;       // loops of such edges
  std::size_t left_open = 0;   // of them, for their caps would cancel the surface
};

/// Caps for the loops of open edges, so that with them each edge is traversed as often one way as
/// the other, and winding numbers are whole everywhere. Vertices at one place count as one.
///
/// kSmooth: the patch is divided until its triangles are as large as the edges of the border
/// (larger further inside, where there would be more than about 20000 points). It leaves the border
/// in the surface's plane, bent as little as possible: a hole in a sphere is closed by its missing
/// part. Where surface and soap film meet at more than 75 degrees, as around a box without a lid,
/// the border is a crease. Holes of up to 6 edges get a fan. So do those of kFlat and kSmooth whose
/// loops are traversed twice, around faces that are turned against their neighbors.
///
/// With `leaves_losses` some loops stay open:
/// - that around a sheet, whose cap would be the sheet turned over: a part that, closed, would have
/// on
///   average no more than 3 % of its width as thickness. Its holes are closed, if they are smaller
///   than a quarter of it;
/// - one that others close already, as the borders of pieces that together are a surface: what is
///   behind the cap is inside by the winding number of the mesh, and would be outside;
/// - one whose cap is turned inside out, unless the whole mesh is.
///
/// The same for any number of threads. Throws as voxelize does for a mesh that is no mesh;
/// Error(kCancelled).
Caps close_holes(const InputMesh& mesh, const CloseHolesOptions& options);

}  // namespace prefilter
