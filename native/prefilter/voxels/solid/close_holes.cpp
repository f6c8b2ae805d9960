// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/close_holes.h"

#include "prefilter/voxels/solid/border_loops.h"
#include "prefilter/voxels/solid/cap_losses.h"
#include "prefilter/voxels/solid/closed_parts.h"
#include "prefilter/voxels/solid/loop_caps.h"
#include "prefilter/voxels/solid/sheets.h"

namespace prefilter {

Caps close_holes(const InputMesh& mesh, const CloseHolesOptions& options) {
  check_mesh(mesh, kLargestCoordinate);
  const auto part = [&](double from, double to) { return options.run.part(from, to); };
  Caps result;
  if (is_balanced(mesh, part(0.0, 0.05))) return result;
  const BorderLoops loops = border_loops(mesh, part(0.0, 0.4));
  result.open_edges = loops.open_edges;
  result.holes = loops.size();
  std::vector<unsigned char> is_kept(loops.size(), 1);
  if (options.leaves_losses) drop_single_face_loops(loops, is_kept);
  std::vector<LoopCap> caps = first_caps(mesh, loops, is_kept, options.method, part(0.4, 0.5));
  CappedSolids solids;
  if (options.leaves_losses) {
    solids = drop_sheet_loops(mesh, loops, caps, part(0.5, 0.55), is_kept);
  }
  if (options.method == HoleMethod::kSmooth) {
    smooth_caps(mesh, loops, is_kept, part(0.55, 0.9), &caps);
  }
  drop_canceling_caps(mesh, loops, caps, solids, part(0.9, 0.99), is_kept);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (is_kept[i] != 0) {
      append_cap(mesh.positions.size(), loops.loop(i), caps[i], &result);
    } else {
      ++result.left_open;
    }
  }
  options.run.report(1.0);
  return result;
}

}  // namespace prefilter
