// SPDX-License-Identifier: GPL-3.0-or-later

// Polygons of a mesh as triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// Triangulates the polygons of a mesh, concave ones too, without new vertices.
///
/// `corners` has the vertices of all polygons, one polygon after another, and `sizes` the number of
/// corners of each. The triangles are three indices into `corners` each, so that what a corner has
/// beside its vertex, such as UVs, can follow; they are ordered by polygon and wound like it.
/// Polygons with fewer than three corners have no triangles.
///
/// The triangles of a polygon cover just the inside of it, each point once, where the polygon does
/// not cross itself in its projection along its normal (by Newell); it may touch itself, as one
/// does whose holes are joined to its outline by an edge that is there twice. A polygon that
/// crosses itself gets triangles with the same signed area in that projection. A convex one becomes
/// a fan around its first corner. Where two corners of a triangle would be at one place there is
/// none.
///
/// Throws Error for an index that names no vertex, for sizes below 0 or whose sum is not the number
/// of corners; Error(kCancelled).
std::vector<std::array<std::int64_t, 3>> triangulate_polygons(const PositionView& positions,
                                                              std::span<const std::int64_t> corners,
                                                              std::span<const std::int64_t> sizes,
                                                              const Progress& progress);

}  // namespace prefilter
