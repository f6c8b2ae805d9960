// SPDX-License-Identifier: GPL-3.0-or-later

// Triangulation of polygon meshes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Triangulates the polygons of a mesh, including concave ones, without new vertices.
///
/// `corners` contains the vertices of all polygons, one polygon after another, and `sizes` the
/// number of corners of each. Triangles are indices into `corners`, so that other corner attributes
/// such as UVs carry over; they are ordered by polygon and have its orientation. Polygons with
/// fewer than three corners yield no triangles.
///
/// The triangles exactly cover the inside of a polygon that does not cross itself when projected
/// along its Newell normal. It may touch itself, like a polygon whose holes are connected to its
/// outline by doubled edges. For a self-crossing polygon the signed area of the triangles in that
/// projection is correct. A convex polygon becomes a fan around its first corner. Triangles with
/// two corners at the same position are omitted.
///
/// Throws Error for an index out of range, and for negative sizes or ones that do not sum to the
/// number of corners; Error(kCancelled).
std::vector<std::array<std::int64_t, 3>> triangulate_polygons(const PositionView& positions,
                                                              std::span<const std::int64_t> corners,
                                                              std::span<const std::int64_t> sizes,
                                                              const Run& run);

}  // namespace prefilter
