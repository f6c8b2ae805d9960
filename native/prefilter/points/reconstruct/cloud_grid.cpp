// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/cloud_grid.h"

#include <cmath>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"
#include "prefilter/voxels/voxelize.h"

namespace prefilter {
namespace {

SampleGrid grid_around(const Box& box, int depth) {
  SampleGrid grid;
  grid.depth = depth;
  int longest = 0;
  for (int a = 1; a < 3; ++a) {
    if (box.size(a) > box.size(longest)) longest = a;
  }
  grid.turn = (longest + 1) % 3;
  const Box cube = cube_around(box, depth);
  check_box(cube, "points");
  grid.low = grid.turned(cube.low);
  grid.cell = cube.size(0) / std::ldexp(1.0, depth);
  return grid;
}

// Relative tolerance of a requested cell size, for sizes rounded to single precision or copied from
// a message.
constexpr double kSizeRounding = 1e-6;

// Depth of the tree; it follows from the points' density where the options give neither depth nor
// cell size.
int depth_for(const Box& box, const ThinnedPoints& thinned, const ReconstructOptions& options) {
  if (!options.cell_size) {
    if (options.depth) return *options.depth;
    return automatic_depth(thinned, box, options.run.part(0.1, 0.12));
  }
  const auto cell_at = [&](int depth) {
    return cube_around(box, depth).size(0) / std::ldexp(1.0, depth);
  };
  for (int depth = 1; depth <= kMaxTreeDepth; ++depth) {
    if (cell_at(depth) <= *options.cell_size * (1.0 + kSizeRounding)) return depth;
  }
  throw_invalid("cell_size: " + to_text(*options.cell_size) + " would need more than " +
                std::to_string(1 << kMaxTreeDepth) + " cells per axis; use " +
                to_text(cell_at(kMaxTreeDepth) * (1.0 + 1e-5)) + " or more");  // not rounded down
}

// As a share of the cell: coordinates rounded to coarser steps cause visible stairs in the surface.
constexpr double kCoarseStep = 0.25;
}  // namespace

SampleGrid grid_of(const Box& box, const ThinnedPoints& thinned,
                   const ReconstructOptions& options) {
  return grid_around(box, depth_for(box, thinned, options));
}

void describe_grid(const SampleGrid& grid, const CloudExtent& extent, ReconstructReport* report) {
  report->points = extent.points;
  report->dropped = extent.dropped;
  report->strays = extent.strays;
  report->depth = grid.depth;
  report->cell = grid.cell;
  const double step = extent.steps.step();
  if (step > kCoarseStep * grid.cell) report->float_step = step;
}

}  // namespace prefilter
