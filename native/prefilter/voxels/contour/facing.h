// SPDX-License-Identifier: GPL-3.0-or-later

// Which way triangles near edges face, beside the surface that they stand for.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_set>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour/feature_surface.h"
#include "prefilter/voxels/contour/sharp_vertices.h"

namespace prefilter {

/// The labels whose normals point into the shape, as those of what was cut away do.
std::unordered_set<std::int32_t> turned_labels(const VertexSamples& samples);

/// Whether a triangle of this label faces away from the normals of all its sampled corners, or is
/// so small beside a cell that rounding makes it flat. One with a corner of another label is not
/// upside down, as that has no side of its own.
bool is_upside_down(const MeshView<std::int32_t>& mesh, std::size_t triangle, std::int32_t label,
                    const VertexSamples& samples, const std::unordered_set<std::int32_t>& turned,
                    double cell);

/// Whether two triangles lie along the surface on both sides of a convex edge that turns by more
/// than 100 degrees, and the side between them is close to that. It is no fold; a crevice is one.
bool are_at_edge(const MeshView<std::int32_t>& mesh, std::span<const std::int32_t> labels,
                 const std::array<std::uint32_t, 2>& triangles, const FeatureSurface& surface,
                 const VertexSamples& samples, const std::unordered_set<std::int32_t>& turned);

}  // namespace prefilter
