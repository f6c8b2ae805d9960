// SPDX-License-Identifier: GPL-3.0-or-later

// Normals of points whose triangles, or places in a scanner's grid, are known.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/range_grid.h"

namespace prefilter {

/// The normal of each vertex, 1 long: the mean of those of its triangles, by area. Zero for a
/// vertex without any, or whose triangles have no area or positions that are not finite. Throws
/// Error for an index that names no vertex; Error(kCancelled).
std::vector<Vector3> mesh_normals(const InputMesh& mesh, const Progress& progress);

/// What a scanner's grid tells of its points.
struct GridNormals {
  std::vector<Vector3> normals;
  /// How sure points are, 0 to 1: the cosine of the angle at which the surface was seen, and less
  /// within six places of where it ends in the grid, down to a seventh (Curless and Levoy 1996).
  std::vector<float> weights;
};

/// Normals by the triangles between neighbors in the grid. Triangles with an edge over four times
/// as long as usual join a surface to what is behind it, and are left out, so points at the ends of
/// the surface may have none, and weigh nothing. All point to the side that more of the surface
/// shows to the viewpoint, or without one to where z is larger, as the scanners of Stanford's range
/// scans look along -z. Throws Error for an index that names no point, a grid of another size than
/// it says, a viewpoint that is not finite; Error(kCancelled).
GridNormals grid_normals(std::span<const Vector3> points, const RangeGrid& grid,
                         const std::optional<Vector3>& viewpoint, const Progress& progress);

}  // namespace prefilter
