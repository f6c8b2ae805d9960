// SPDX-License-Identifier: GPL-3.0-or-later

// Parts of a mesh that have two sides and no inside.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/solid/border_loops.h"
#include "prefilter/voxels/solid/loop_caps.h"

namespace prefilter {

/// The parts of a mesh that are no sheets, once they have their caps.
struct CappedSolids {
  std::vector<std::size_t> loops;  // theirs, in order
  bool has_others = false;         // whether the mesh has more than one part
  bool is_turned = false;          // whether it is inside out, in all
};

/// Drops the loops around triangles by themselves, whose caps would be the same, turned over.
void leave_single_faces(const BorderLoops& loops, std::span<unsigned char> is_kept);

/// Finds the parts with loops that enclose nothing even with their caps, which have no more than
/// 3 % of their width as thickness (12 % where the mesh is inside out). Drops their loops, but for
/// holes of up to a quarter of their area. `is_kept` has an entry for each loop.
CappedSolids leave_sheets(const InputMesh& mesh, const BorderLoops& loops,
                          std::span<const LoopCap> caps, const Progress& progress,
                          std::span<unsigned char> is_kept);

}  // namespace prefilter
