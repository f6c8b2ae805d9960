// SPDX-License-Identifier: GPL-3.0-or-later

// For each corner of a remeshed surface, finds the nearest point of the original mesh.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/geometry/nearest.h"

namespace prefilter {

/// Points of a mesh, and the index of the point for each corner of a surface's triangles.
struct CornerPoints {
  std::vector<SurfacePoint> points;  // first, one for each vertex
  std::vector<std::array<std::int32_t, 3>> corners;
};

/// For each corner of a surface's triangles, finds the nearest point on those triangles of a mesh
/// that have the same label as the triangle's origin. A vertex between several labels has a point
/// for each; the point for its first triangle is at the vertex's own index.
///
/// `origins` holds the index of a mesh triangle for each surface triangle; nearby origins speed up
/// the search. Throws Error for an invalid surface or mesh, if the numbers of labels and origins do
/// not match the triangles, and for an origin out of range; Error(kCancelled).
CornerPoints find_corner_points(const InputMesh& surface, std::span<const std::int32_t> origins,
                                const InputMesh& mesh, std::span<const std::int32_t> labels,
                                const Run& run);

}  // namespace prefilter
