// SPDX-License-Identifier: GPL-3.0-or-later

// For each corner of a surface, the nearest point of the mesh that it was made of.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/geometry/nearest.h"

namespace prefilter {

/// Points of a mesh, and which of them the corners of a surface have.
struct CornerPoints {
  std::vector<SurfacePoint> points;  // first one for each vertex
  std::vector<std::array<std::int32_t, 3>> corners;
};

/// For each corner of a surface's triangle, the nearest point of those triangles of a mesh that
/// have the label of the triangle that it came from. A vertex between triangles of several labels
/// has a point for each; that of its first triangle is the vertex's own.
///
/// `origins` holds a triangle of the mesh for each one of the surface; what is near is found fast.
/// Throws Error for a surface or mesh that is none, labels and origins that are not as many as the
/// triangles, an origin that names no triangle; Error(kCancelled).
CornerPoints find_corner_points(const InputMesh& surface, std::span<const std::int32_t> origins,
                                const InputMesh& mesh, std::span<const std::int32_t> labels,
                                const Progress& progress, int threads);

}  // namespace prefilter
