// SPDX-License-Identifier: GPL-3.0-or-later

// Charts that meet themselves at a seam, as that of a tube that is slit, are cut into pieces.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/geometry/charts.h"

namespace prefilter {

/// How the triangles of a mesh meet.
struct ChartLinks {
  /// The triangles beyond the edges of each that are no seams; none if negative.
  std::vector<std::array<std::int32_t, 3>> beyond;
  /// The triangles on both sides of the seams whose UVs differ at both ends.
  std::vector<std::array<std::uint32_t, 2>> slits;
};

/// Whether UVs are the same at a seam.
bool are_near_uvs(const std::array<float, 2>& a, const std::array<float, 2>& b);

/// Gives pieces of charts numbers of their own, so that triangles of one number have the same UVs
/// wherever they share a vertex. Two sides of a slit are parted half way between them, by the way
/// from middle to middle of triangles.
///
/// `place` is the same for vertices that count as one; `charts` has a number for each triangle,
/// from 0 without gaps in order of first triangles, and so it has afterward.
void cut_charts(const InputMesh& mesh, std::span<const CornerUvs> maps,
                std::span<const std::uint32_t> place, const ChartLinks& links,
                const Progress& progress, std::vector<std::int32_t>* charts);

}  // namespace prefilter
