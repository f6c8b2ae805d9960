// SPDX-License-Identifier: GPL-3.0-or-later

// Divides a mesh into patches that can only be oriented as a whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/solid/edge_table.h"

namespace prefilter {

/// Triangles connected by edges that have exactly two triangles.
struct FacePatch {
  std::size_t triangles = 0;
  double area = 0.0;
  double volume = 0.0;      // oriented; of the cone from its first corner, exact for closed patches
  double border = 0.0;      // total length of its unbalanced edges
  Vector3 border_middle{};  // center of these edges
  double turned_area = 0.0;   // area of the triangles turned to match the others
  bool is_orientable = true;  // no edge is traversed in the same direction by both of its triangles
  Box box = kEmptyBox;

  bool is_closed() const { return is_orientable && border == 0.0; }
};

/// All patches, in order of their first triangles.
struct Patches {
  std::vector<FacePatch> patches;
  std::vector<std::uint32_t> patch_of;  // of each triangle
  std::vector<std::uint8_t> is_turned;  // of each triangle: whether it must be turned
};

/// Finds the patches, and the turns that make each consistent while turning at most half of its
/// area.
Patches find_patches(const MeshView<std::int32_t>& mesh, const Run& run);

}  // namespace prefilter
