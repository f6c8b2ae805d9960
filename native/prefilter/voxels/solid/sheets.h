// SPDX-License-Identifier: GPL-3.0-or-later

// Finds sheets: parts of a mesh with two sides but no inside.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/solid/border_loops.h"
#include "prefilter/voxels/solid/loop_caps.h"

namespace prefilter {

/// The parts that are not sheets once capped.
struct CappedSolids {
  std::vector<std::size_t> loops;  // their loops, in order
  bool has_others = false;         // whether the mesh has more than one part
  bool is_turned = false;          // whether the mesh as a whole is inside out
};

/// Clears `is_kept` for loops around single triangles, whose caps would be the reversed triangles.
void drop_single_face_loops(const BorderLoops& loops, std::span<unsigned char> is_kept);

/// Finds parts that enclose nothing even with their caps: their thickness is at most 3 % of their
/// width (12 % where the mesh is inside out). Clears `is_kept` for their loops, except for holes of
/// up to a quarter of their area. `is_kept` has one entry per loop.
CappedSolids drop_sheet_loops(const InputMesh& mesh, const BorderLoops& loops,
                              std::span<const LoopCap> caps, const Run& run,
                              std::span<unsigned char> is_kept);

}  // namespace prefilter
