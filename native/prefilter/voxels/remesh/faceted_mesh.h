// SPDX-License-Identifier: GPL-3.0-or-later

// A closed mesh, with the features to preserve when its triangles change.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Role of a vertex.
enum class VertexKind : std::uint8_t {
  kSurface,  // point of a smooth region
  kEdge,     // point of an edge of the shape, or of the border between two labels
  kCorner,   // point where such edges meet or end
};

/// The label of a triangle that may lie on either side of a crease.
inline constexpr std::int32_t kNoLabel = -1;

/// An indexed triangle mesh; counterclockwise seen from outside.
///
/// An edge is a crease if its two triangles have different labels, neither of which is kNoLabel, or
/// if neither of its ends is kSurface and the normals of its triangles differ by more than 15
/// degrees.
struct FacetedMesh {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::int32_t> labels;  // of each triangle; empty: all the same
  std::vector<VertexKind> kinds;     // of each vertex; empty: all kSurface
};

}  // namespace prefilter
