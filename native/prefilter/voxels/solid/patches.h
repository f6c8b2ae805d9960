// SPDX-License-Identifier: GPL-3.0-or-later

// Parts of a surface whose faces can be turned only together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/solid/edge_table.h"

namespace prefilter {

/// Triangles that hang together by edges on which there are two of them.
struct FacePatch {
  std::size_t triangles = 0;
  double area = 0.0;
  double volume = 0.0;  // as turned, of the cone from its first corner; exact where it is closed
  double border = 0.0;  // the length of the edges along which it is open
  Vector3 border_middle{};    // of these edges
  double turned_area = 0.0;   // of the triangles that had to be turned against the others
  bool is_orientable = true;  // no edge is left that both of its triangles run along the same way
  Box box = kEmptyBox;

  bool is_closed() const { return is_orientable && border == 0.0; }
};

/// The patches of a mesh, in the order of their first triangles.
struct Patches {
  std::vector<FacePatch> patches;
  std::vector<std::uint32_t> patch_of;  // of each triangle
  std::vector<std::uint8_t> is_turned;  // of each triangle: whether it is to be turned
};

/// The patches, with each triangle turned so that it goes with its neighbors, and each patch so
/// that less of its area is turned than not.
Patches find_patches(const MeshView<std::int32_t>& mesh, const Progress& progress, int threads);

}  // namespace prefilter
