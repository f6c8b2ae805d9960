// SPDX-License-Identifier: GPL-3.0-or-later

// The charts of UV maps.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// The UVs of a mesh's triangles, per corner.
using CornerUvs = std::span<const std::array<std::array<float, 2>, 3>>;

/// Numbers the charts of a mesh: returns the chart of each triangle, numbered by first triangles
/// from 0. Charts are connected by edges that are not a seam of any map. An edge is a seam if the
/// UVs of its two triangles differ by more than 1e-4 at an end; edges with one triangle, or three
/// and more, separate charts too. Vertices at the same position are identified. If triangles of a
/// chart have different UVs at a vertex, as on both sides of a slit, the chart is divided, with a
/// border about half way between the sides.
///
/// Throws Error for an invalid mesh, and for a map with a different number of triangles;
/// Error(kCancelled).
std::vector<std::int32_t> find_charts(const InputMesh& mesh, std::span<const CornerUvs> maps,
                                      const Run& run);

}  // namespace prefilter
