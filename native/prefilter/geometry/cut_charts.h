// SPDX-License-Identifier: GPL-3.0-or-later

// Divides charts that adjoin themselves at a seam, such as that of an unrolled tube.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/geometry/charts.h"

namespace prefilter {

/// Adjacency of the triangles of a mesh.
struct ChartLinks {
  /// The triangles beyond the three edges of each triangle; negative at seams.
  std::vector<std::array<std::int32_t, 3>> beyond;
  /// Pairs of triangles on both sides of seams whose UVs differ at both ends.
  std::vector<std::array<std::uint32_t, 2>> slits;
};

/// Whether UVs are equal up to the tolerance of seams.
bool are_near_uvs(const std::array<float, 2>& a, const std::array<float, 2>& b);

/// Divides charts so that triangles with the same number have the same UVs at every shared vertex.
/// The two sides of a slit are separated half way between them, measured along triangle centers.
///
/// `place` is equal for vertices that are identified. `charts` has a number per triangle,
/// consecutive from 0 in order of first triangles, both before and after.
void cut_charts(const InputMesh& mesh, std::span<const CornerUvs> maps,
                std::span<const std::uint32_t> place, const ChartLinks& links, const Run& run,
                std::vector<std::int32_t>* charts);

}  // namespace prefilter
