// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/wavelet/leaf_surface.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "prefilter/wavelet/column_height.h"

namespace prefilter {
namespace {

// Below this gradient there is no surface; at a half-space it is about 1/2.
constexpr double kMinGradient = 0.2;
// Occupancies this close to 0 or 1 are empty or full.
constexpr double kWholeTolerance = 1e-5;
// Rises below this are ignored; their effect is as small.
constexpr double kMinRise = 1e-6;
constexpr int kMaxHeightSteps = 40;
constexpr double kHeightTolerance = 1e-9;

// Mean over the unit square of a plane's positive part, and its derivative by the height: the
// fraction of the square where the plane is positive.
struct Above {
  double mean;
  double share;
};

// For a plane with this height at the center, which rises by `a` and `b` from side to side.
Above above(double height, double a, double b) {
  a = std::abs(a);
  b = std::abs(b);
  if (a < b) std::swap(a, b);
  const double top = (a + b) / 2.0;
  if (height >= top) return {height, 1.0};
  if (height <= -top) return {0.0, 0.0};
  if (a < kMinRise) return {std::max(height, 0.0), height > 0.0 ? 1.0 : 0.0};
  if (b < kMinRise) {
    const double reach = height + a / 2.0;
    return {std::max(reach, 0.0) * reach / (2.0 * a), std::clamp(reach / a, 0.0, 1.0)};
  }
  double mean = 0.0;
  double share = 0.0;
  const double across = (a - b) / 2.0;
  for (const auto& [x, sign] : {std::pair{height + top, 1.0}, std::pair{height + across, -1.0},
                                std::pair{height - across, -1.0}, std::pair{height - top, 1.0}}) {
    if (x <= 0.0) continue;
    share += sign * x * x / 2.0;
    mean += sign * x * x * x / 6.0;
  }
  return {std::clamp(mean / (a * b), std::max(height, 0.0), top),
          std::clamp(share / (a * b), 0.0, 1.0)};
}

}  // namespace

float occupancy_at(const CellTree& tree, int depth, const LeafPlace& at) {
  for (const int x : at) {
    if (x < 0 || x >= 1 << depth) return 0.0F;
  }
  float value = tree.root;
  std::size_t block = 0;
  const int most = std::min(depth, tree.depth());
  for (int k = 0; k < most; ++k) {
    const int shift = depth - k - 1;
    const int o =
        ((at[0] >> shift) & 1) | (((at[1] >> shift) & 1) << 1) | (((at[2] >> shift) & 1) << 2);
    const TreeLevel& level = tree.levels[static_cast<std::size_t>(k)];
    value = level.blocks[block][static_cast<std::size_t>(o)];
    if (k + 1 == most || !level.is_split(block, o)) break;
    block = level.child(block, o);
  }
  return value;
}

LeafSurface::Patch LeafSurface::patch(double first_low, double first_high, double second_low,
                                      double second_high) const {
  const double x = (first_low + first_high) / 2.0;
  const double y = (second_low + second_high) / 2.0;
  const double dx = first_high - first_low;
  const double dy = second_high - second_low;
  const auto slope = [&](int side) { return static_cast<double>(slopes_[side]); };
  const auto curvature = [&](int side) { return static_cast<double>(curvatures_[side]); };
  const auto twist = static_cast<double>(twist_);
  const double height = height_ + slope(0) * x + slope(1) * y + twist * x * y +
                        curvature(0) / 2.0 * (x * x + (dx * dx - 1.0) / 12.0) +
                        curvature(1) / 2.0 * (y * y + (dy * dy - 1.0) / 12.0);
  return {height, (slope(0) + curvature(0) * x + twist * y) * dx,
          (slope(1) + curvature(1) * y + twist * x) * dy};
}

LeafSurface::Patch LeafSurface::patch(const Box& box) const {
  const int first = (axis_ + 1) % 3;
  const int second = (axis_ + 2) % 3;
  return patch(box.low[first] - 0.5, box.high[first] - 0.5, box.low[second] - 0.5,
               box.high[second] - 0.5);
}

std::array<double, 2> LeafSurface::extent(const Box& box) const {
  if (is_up_) return {box.low[axis_] - 0.5, box.high[axis_] - 0.5};
  return {0.5 - box.high[axis_], 0.5 - box.low[axis_]};
}

double LeafSurface::share(const Box& box) const {
  const Patch over = patch(box);
  const auto [low, high] = extent(box);
  const double volume = above(over.height - low, over.first_rise, over.second_rise).mean -
                        above(over.height - high, over.first_rise, over.second_rise).mean;
  return std::clamp(volume / (high - low), 0.0, 1.0);
}

std::optional<float> LeafSurface::uniform_value(const Box& box) const {
  const Patch over = patch(box);
  const double first = box.size((axis_ + 1) % 3);
  const double second = box.size((axis_ + 2) % 3);
  const double reach = (std::abs(over.first_rise) + std::abs(over.second_rise)) / 2.0 +
                       static_cast<double>(std::abs(curvatures_[0])) * first * first / 8.0 +
                       static_cast<double>(std::abs(curvatures_[1])) * second * second / 8.0 +
                       static_cast<double>(std::abs(twist_)) * first * second / 4.0;
  const auto [low, high] = extent(box);
  if (over.height + reach <= low) return 0.0F;
  if (over.height - reach >= high) return 1.0F;
  return std::nullopt;
}

bool LeafSurface::has_heights(const CellTree& tree, int depth, const LeafPlace& at) {
  const auto height_of = [&](int i, int j) {
    return column_height([&](int step) {
      LeafPlace place = at;
      place[static_cast<std::size_t>(axis_)] += is_up_ ? step : -step;
      place[static_cast<std::size_t>((axis_ + 1) % 3)] += i;
      place[static_cast<std::size_t>((axis_ + 2) % 3)] += j;
      return occupancy_at(tree, depth, place);
    });
  };
  const std::optional<float> middle = height_of(0, 0);
  if (!middle) return false;
  height_ = static_cast<double>(*middle) - 0.5;
  for (int side = 0; side < 2; ++side) {
    const std::optional<float> low = side == 0 ? height_of(-1, 0) : height_of(0, -1);
    const std::optional<float> high = side == 0 ? height_of(1, 0) : height_of(0, 1);
    if (!low || !high) return false;
    slopes_[side] = (*high - *low) / 2.0F;
    curvatures_[side] = *high - 2.0F * *middle + *low;
  }
  twist_ = 0.0F;
  for (const int i : {-1, 1}) {
    for (const int j : {-1, 1}) {
      const std::optional<float> corner = height_of(i, j);
      if (!corner) {
        twist_ = 0.0F;
        return true;
      }
      twist_ += static_cast<float>(i * j) * *corner / 4.0F;
    }
  }
  return true;
}

void LeafSurface::fit_height(double occupancy, int parts) {
  std::vector<Patch> patches;
  const double unit = 1.0 / parts;
  double low = 1.0;
  double high = -1.0;
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; j < parts; ++j) {
      const Patch over =
          patch(i * unit - 0.5, (i + 1) * unit - 0.5, j * unit - 0.5, (j + 1) * unit - 0.5);
      patches.push_back(over);
      const double rise = (std::abs(over.first_rise) + std::abs(over.second_rise)) / 2.0;
      low = std::min(low, -0.5 - rise - (over.height - height_));
      high = std::max(high, 0.5 + rise - (over.height - height_));
    }
  }
  double at = std::clamp(height_, low, high);
  for (int step = 0; step < kMaxHeightSteps; ++step) {
    Above sum{0.0, 0.0};
    for (const Patch& over : patches) {
      const double height = over.height - height_ + at;
      const Above of_bottom = above(height + 0.5, over.first_rise, over.second_rise);
      const Above of_top = above(height - 0.5, over.first_rise, over.second_rise);
      sum.mean += of_bottom.mean - of_top.mean;
      sum.share += of_bottom.share - of_top.share;
    }
    const double excess = sum.mean * unit * unit - occupancy;
    if (std::abs(excess) < kHeightTolerance) break;
    (excess > 0.0 ? high : low) = at;
    const double next = at - excess / (sum.share * unit * unit);
    at = next > low && next < high ? next : (low + high) / 2.0;
  }
  height_ = at;
}

std::optional<LeafSurface> LeafSurface::find(const CellTree& tree, int depth, const LeafPlace& at,
                                             int parts) {
  Vector3 gradient{};
  bool touches_full = false;
  bool touches_empty = false;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const int steps = std::abs(x) + std::abs(y) + std::abs(z);
        if (steps == 0) continue;
        const auto value =
            static_cast<double>(occupancy_at(tree, depth, {at[0] + x, at[1] + y, at[2] + z}));
        const double weight = std::ldexp(1.0, 1 - steps) / 8.0 * value;
        touches_full = touches_full || value >= 1.0 - kWholeTolerance;
        touches_empty = touches_empty || value <= kWholeTolerance;
        gradient = gradient + Vector3{x * weight, y * weight, z * weight};
      }
    }
  }
  LeafSurface surface;
  for (int a = 1; a < 3; ++a) {
    if (std::abs(gradient[a]) > std::abs(gradient[surface.axis_])) surface.axis_ = a;
  }
  const double steepest = gradient[surface.axis_];
  if (std::sqrt(dot(gradient, gradient)) < kMinGradient) return std::nullopt;
  // A plane through a cell leaves neighbors on both sides full and empty. If not, the occupancy
  // fades over many cells, as winding numbers do across holes of a mesh.
  if (!touches_full || !touches_empty) return std::nullopt;
  surface.is_up_ = steepest < 0.0;
  if (!surface.has_heights(tree, depth, at)) {
    surface.height_ = 0.0;
    surface.curvatures_ = {};
    surface.twist_ = 0.0F;
    for (int side = 0; side < 2; ++side) {
      const double across = gradient[(surface.axis_ + 1 + side) % 3];
      surface.slopes_[side] = static_cast<float>(across / std::abs(steepest));
    }
  }
  const auto occupancy = static_cast<double>(occupancy_at(tree, depth, at));
  surface.fit_height(occupancy, parts);
  return surface;
}

}  // namespace prefilter
