// SPDX-License-Identifier: GPL-3.0-or-later

// Normals of points from their triangles or from a scanner's grid.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/points/range_grid.h"

namespace prefilter {

/// Unit normal of each vertex: the area-weighted mean of its triangles' normals. Zero for a vertex
/// without triangles, or whose triangles have no area or positions that are not finite. Throws
/// Error for an invalid vertex index; Error(kCancelled).
std::vector<Vector3> mesh_normals(const InputMesh& mesh, const Run& run);

/// Normals and weights derived from a scanner's grid.
struct GridNormals {
  std::vector<Vector3> normals;
  /// Confidence, 0 to 1: the cosine of the viewing angle, reduced within six grid positions of the
  /// end of the surface, down to a seventh (Curless and Levoy 1996).
  std::vector<float> weights;
};

/// Normals from the triangles between neighbors in the grid. Triangles with an edge over four times
/// the median length connect a surface to the background and are left out; points at the ends of
/// the surface may then have no normal, and weight 0. All normals are oriented so that most of the
/// surface faces the viewpoint or, without one, +z, as the scanners of Stanford's range scans look
/// along -z. Throws Error for an invalid point index, a grid whose size does not match its rows and
/// columns, or a viewpoint that is not finite; Error(kCancelled).
GridNormals grid_normals(std::span<const Vector3> points, const RangeGrid& grid,
                         const std::optional<Vector3>& viewpoint, const Run& run);

}  // namespace prefilter
