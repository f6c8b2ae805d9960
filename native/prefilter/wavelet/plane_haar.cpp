// SPDX-License-Identifier: GPL-3.0-or-later

// Section 3.2.2: fluxes are summed from the bricks up to the root.
#include "prefilter/wavelet/plane_haar.h"

#include <algorithm>
#include <utility>

namespace prefilter {
namespace {

// The mean over the root, from the curves in it and at its sides. The field of a mean has no
// compact support, so there are four estimates: along either axis, from either side. The mean of
// the middle two is used; for closed outlines all agree.
double root_mean(const PlaneFlux& root, const PlaneFlux& at_sides, double side) {
  const double area_x = root.area_x + at_sides.area_x / side;
  const double area_y = root.area_y + at_sides.area_y / side;
  const double moment_x = root.moment_x + at_sides.moment_x / (side * side);
  const double moment_y = root.moment_y + at_sides.moment_y / (side * side);
  std::array<double, 4> estimates = {moment_x, moment_x - area_x, moment_y, moment_y - area_y};
  std::sort(estimates.begin(), estimates.end());
  return 0.5 * (estimates[1] + estimates[2]);
}

// Maps coordinates in the bounding box of some cells to their index.
class PlaceTable {
 public:
  PlaceTable(int low_x, int low_y, int end_x, int end_y)
      : low_x_(low_x), low_y_(low_y), width_(end_x - low_x) {
    places_.assign(static_cast<std::size_t>(width_) * (end_y - low_y), -1);
  }
  std::int32_t& at(int x, int y) {
    return places_[static_cast<std::size_t>(y - low_y_) * width_ + (x - low_x_)];
  }

 private:
  int low_x_;
  int low_y_;
  int width_;
  std::vector<std::int32_t> places_;
};

// Concatenates the bricks of all strips, which are emptied.
StripBricks joined(std::span<StripBricks> strips) {
  if (strips.size() == 1) return std::move(strips[0]);
  StripBricks all;
  std::size_t count = 0;
  for (const StripBricks& strip : strips) count += strip.bricks.size();
  all.bricks.reserve(count);
  all.fluxes.reserve(count);
  for (StripBricks& strip : strips) {
    all.bricks.insert(all.bricks.end(), strip.bricks.begin(), strip.bricks.end());
    all.fluxes.insert(all.fluxes.end(), strip.fluxes.begin(), strip.fluxes.end());
    all.at_sides += strip.at_sides;
    strip = {};
  }
  return all;
}

// The parents of cells, in the order of their first children. Elements of `children` have
// coordinates x, y; flux_of(i) is the flux of child i.
template <typename Node, typename Child, typename FluxOf>
std::vector<Node> parents_of(const std::vector<Child>& children, const FluxOf& flux_of) {
  int low_x = children[0].x;
  int low_y = children[0].y;
  int high_x = low_x;
  int high_y = low_y;
  for (const Child& child : children) {
    low_x = std::min(low_x, child.x);
    low_y = std::min(low_y, child.y);
    high_x = std::max(high_x, child.x);
    high_y = std::max(high_y, child.y);
  }
  PlaceTable table(low_x >> 1, low_y >> 1, (high_x >> 1) + 1, (high_y >> 1) + 1);
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < children.size(); ++i) {
    const int x = children[i].x;
    const int y = children[i].y;
    std::int32_t& slot = table.at(x >> 1, y >> 1);
    if (slot < 0) {
      slot = static_cast<std::int32_t>(nodes.size());
      nodes.push_back({x >> 1, y >> 1});
    }
    const int quadrant = (x & 1) | ((y & 1) << 1);
    nodes[slot].next[quadrant] = static_cast<int>(i);
    nodes[slot].fluxes[quadrant] = flux_of(i);
  }
  return nodes;
}

}  // namespace

PlaneHaar::PlaneHaar(const PlaneGrid& grid, std::span<StripBricks> strips) : grid_(grid) {
  StripBricks all = joined(strips);
  bricks_ = std::move(all.bricks);
  const double side = std::ldexp(1.0, grid.depth);
  if (bricks_.empty()) {
    mean_ = root_mean({}, all.at_sides, side);
    return;
  }
  const int coarse = grid.depth - kPlaneBrickDepth;
  levels_.resize(coarse);
  for (int k = coarse - 1; k >= 0; --k) {
    if (k == coarse - 1) {
      levels_[k] = parents_of<Node>(bricks_, [&](std::size_t i) { return all.fluxes[i]; });
    } else {
      const std::vector<Node>& finer = levels_[k + 1];
      levels_[k] = parents_of<Node>(
          finer, [&](std::size_t i) { return flux_of_quadrants(finer[i].fluxes); });
    }
  }
  const PlaneFlux root = coarse > 0 ? flux_of_quadrants(levels_[0][0].fluxes) : all.fluxes[0];
  mean_ = root_mean(root, all.at_sides, side);
}

void PlaneHaar::brick_values(const PlaneBrick& brick, float mean, int cell_depth,
                             BrickValues* values) {
  constexpr int kSide = kPlaneBrickSide;
  const auto quadrants = brick.steps[0].values(mean);
  for (int a = 0; a < 4; ++a) {
    const auto sixteenths = brick.steps[1 + a].values(quadrants[a]);
    for (int b = 0; b < 4; ++b) {
      const int i = 4 * a + b;
      auto cells = brick.steps[5 + i].values(sixteenths[b]);
      const auto touched = static_cast<unsigned>(brick.touched >> (4 * i)) & 15U;
      for (int c = 0; c < 4; ++c) {
        if (((touched >> c) & 1U) == 0U) cells[c] = without_rounding(cells[c]);
        if (cell_depth > 0) cells[c] = cell_depth == 1 ? sixteenths[b] : quadrants[a];
      }
      const int x = 2 * (b & 1) + 4 * (a & 1);
      const int y = 2 * (b >> 1) + 4 * (a >> 1);
      float* out = values->data() + y * kSide + x;
      out[0] = cells[0];
      out[1] = cells[1];
      out[kSide] = cells[2];
      out[kSide + 1] = cells[3];
    }
  }
}

}  // namespace prefilter
