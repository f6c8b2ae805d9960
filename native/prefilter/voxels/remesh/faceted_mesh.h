// SPDX-License-Identifier: GPL-3.0-or-later

// A closed mesh, and what of it is to be kept where its triangles change.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// What a vertex stands for.
enum class VertexKind : std::uint8_t {
  kSurface,  // a point of a smooth part
  kEdge,     // a point of an edge of the shape, or of the border between two labels
  kCorner,   // where such edges meet or end
};

/// The label of a triangle that may be on either side of a crease.
inline constexpr std::int32_t kNoLabel = -1;

/// Triangles that share vertices; counter-clockwise seen from outside.
///
/// An edge is a crease where its two triangles have labels that differ, and neither is kNoLabel, or
/// where both its ends are of another kind than kSurface and the normals of its triangles are more
/// than 15 degrees apart.
struct FacetedMesh {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::int32_t> labels;  // of each triangle; none: all are of one
  std::vector<VertexKind> kinds;     // of each vertex; none: all are kSurface
};

}  // namespace prefilter
