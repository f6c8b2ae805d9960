// SPDX-License-Identifier: GPL-3.0-or-later

// Orientation of triangles near edges, compared with the surface that they represent.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_set>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour/feature_surface.h"
#include "prefilter/voxels/contour/sharp_vertices.h"

namespace prefilter {

/// The labels of regions with normals that point into the shape, such as surfaces of subtracted
/// shapes.
std::unordered_set<std::int32_t> turned_labels(const VertexSamples& samples);

/// Whether a triangle of this label faces away from the normals of all its sampled corners, or is
/// so small relative to a cell that rounding makes it degenerate. A triangle with a corner of
/// another label is not upside down, since it lies on no single side.
bool is_upside_down(const MeshView<std::int32_t>& mesh, std::size_t triangle, std::int32_t label,
                    const VertexSamples& samples, const std::unordered_set<std::int32_t>& turned,
                    double cell);

/// Whether two triangles lie on both sides of a convex edge of the surface that turns by more than
/// 100 degrees, and their common side is close to it. Such an edge is no fold; a crevice is.
bool are_at_edge(const MeshView<std::int32_t>& mesh, std::span<const std::int32_t> labels,
                 const std::array<std::uint32_t, 2>& triangles, const FeatureSurface& surface,
                 const VertexSamples& samples, const std::unordered_set<std::int32_t>& turned);

}  // namespace prefilter
