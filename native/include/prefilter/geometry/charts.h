// SPDX-License-Identifier: GPL-3.0-or-later

// The charts of UV maps.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// The UVs of a mesh's triangles, corner by corner.
using CornerUvs = std::span<const std::array<std::array<float, 2>, 3>>;

/// A number for each triangle, from 0 in order of their first triangles: the same for those that
/// hang together by edges which are seams of none of the maps. An edge is a seam where its two
/// triangles have UVs at an end that are more than 1e-4 apart; edges of one or three and more
/// triangles part, too. Vertices at one place count as one. Where triangles of one number would
/// have different UVs at a vertex, as on both sides of a slit, they get several: the border between
/// these runs about half way between the sides.
///
/// Throws Error for a mesh that is none, and a map that has not as many triangles;
/// Error(kCancelled).
std::vector<std::int32_t> find_charts(const InputMesh& mesh, std::span<const CornerUvs> maps,
                                      const Progress& progress, int threads);

}  // namespace prefilter
