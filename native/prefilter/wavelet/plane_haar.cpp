// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/wavelet/plane_haar.h"

#include <algorithm>
#include <utility>

namespace prefilter {
namespace {

// The mean over the root from what the curves in it have and from what is at its sides: as the
// field of a mean has no compact support, along either axis and from either side, of which the
// middle two count. For closed outlines all are the same.
double root_mean(const PlaneFlux& root, const PlaneFlux& at_sides, double side) {
  const double area_x = root.area_x + at_sides.area_x / side;
  const double area_y = root.area_y + at_sides.area_y / side;
  const double moment_x = root.moment_x + at_sides.moment_x / (side * side);
  const double moment_y = root.moment_y + at_sides.moment_y / (side * side);
  std::array<double, 4> estimates = {moment_x, moment_x - area_x, moment_y, moment_y - area_y};
  std::sort(estimates.begin(), estimates.end());
  return 0.5 * (estimates[1] + estimates[2]);
}

// Places in a level by their coordinates, within the box that some cells have.
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

}  // namespace

PlaneHaar::PlaneHaar(const PlaneGrid& grid, std::span<StripBricks> strips) : grid_(grid) {
  std::vector<PlaneFlux> fluxes;
  PlaneFlux at_sides;
  std::size_t count = 0;
  for (const StripBricks& strip : strips) count += strip.bricks.size();
  if (strips.size() == 1) {
    bricks_ = std::move(strips[0].bricks);
    fluxes = std::move(strips[0].fluxes);
    at_sides = strips[0].at_sides;
  } else {
    bricks_.reserve(count);
    fluxes.reserve(count);
    for (StripBricks& strip : strips) {
      bricks_.insert(bricks_.end(), strip.bricks.begin(), strip.bricks.end());
      fluxes.insert(fluxes.end(), strip.fluxes.begin(), strip.fluxes.end());
      at_sides += strip.at_sides;
      strip = {};
    }
  }

  const double side = std::ldexp(1.0, grid.depth);
  if (bricks_.empty()) {
    mean_ = root_mean({}, at_sides, side);
    return;
  }
  int low_x = bricks_[0].x;
  int low_y = bricks_[0].y;
  int high_x = low_x;
  int high_y = low_y;
  for (const PlaneBrick& brick : bricks_) {
    low_x = std::min(low_x, brick.x);
    low_y = std::min(low_y, brick.y);
    high_x = std::max(high_x, brick.x);
    high_y = std::max(high_y, brick.y);
  }
  const int coarse = grid.depth - kPlaneBrickDepth;
  levels_.resize(coarse);
  for (int k = coarse - 1; k >= 0; --k) {
    const int up = coarse - k;
    PlaceTable table(low_x >> up, low_y >> up, (high_x >> up) + 1, (high_y >> up) + 1);
    std::vector<Node>& nodes = levels_[k];
    const auto add_child = [&](int x, int y, int place, const PlaneFlux& flux) {
      std::int32_t& slot = table.at(x >> 1, y >> 1);
      if (slot < 0) {
        slot = static_cast<std::int32_t>(nodes.size());
        nodes.push_back({x >> 1, y >> 1});
      }
      const int quadrant = (x & 1) | ((y & 1) << 1);
      nodes[slot].next[quadrant] = place;
      nodes[slot].fluxes[quadrant] = flux;
    };
    if (k == coarse - 1) {
      for (std::size_t i = 0; i < bricks_.size(); ++i) {
        add_child(bricks_[i].x, bricks_[i].y, static_cast<int>(i), fluxes[i]);
      }
    } else {
      const std::vector<Node>& finer = levels_[k + 1];
      for (std::size_t i = 0; i < finer.size(); ++i) {
        add_child(finer[i].x, finer[i].y, static_cast<int>(i), flux_of_quadrants(finer[i].fluxes));
      }
    }
  }
  const PlaneFlux root = coarse > 0 ? flux_of_quadrants(levels_[0][0].fluxes) : fluxes[0];
  mean_ = root_mean(root, at_sides, side);
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
