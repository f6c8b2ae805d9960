// SPDX-License-Identifier: GPL-3.0-or-later

// Orients open parts toward the outside.
#pragma once

#include <cstddef>
#include <span>

#include "prefilter/voxels/solid/patches.h"
#include "prefilter/voxels/solid/triangle_sides.h"
#include "prefilter/voxels/solid/weld.h"

namespace prefilter {

/// Number of parts and faces turned.
struct TurnedParts {
  std::size_t parts = 0;  // as a whole
  std::size_t faces = 0;  // individually

  bool any() const { return parts + faces > 0; }
};

/// Turns open patches as a whole, and individual triangles of those that are not orientable, along
/// with their `sides`. A patch with the outside on both sides is turned if it encloses a negative
/// volume, with a cone over its border, of more than `cell` times its area. `areas` are those of
/// the triangles.
TurnedParts turn_open_parts(const Patches& patches, std::span<const double> areas, double cell,
                            WorkMesh* mesh, std::span<TriangleSides> sides);

}  // namespace prefilter
