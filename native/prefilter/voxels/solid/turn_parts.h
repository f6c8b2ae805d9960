// SPDX-License-Identifier: GPL-3.0-or-later

// Open parts turned so that the outside is in front of them.
#pragma once

#include <cstddef>
#include <span>

#include "prefilter/voxels/solid/patches.h"
#include "prefilter/voxels/solid/triangle_sides.h"
#include "prefilter/voxels/solid/weld.h"

namespace prefilter {

/// How much was turned.
struct TurnedParts {
  std::size_t parts = 0;  // as a whole
  std::size_t faces = 0;  // one by one

  bool any() const { return parts + faces > 0; }
};

/// Turns open patches as a whole, and single triangles of those that cannot be oriented, with their
/// sides. A patch that the outside reaches on both sides is turned if it encloses a negative volume
/// of more than a `cell` times its area, a cone over its border added. `areas` are those of the
/// triangles.
TurnedParts turn_open_parts(const Patches& patches, std::span<const double> areas, double cell,
                            WorkMesh* mesh, std::span<TriangleSides> sides);

}  // namespace prefilter
