// SPDX-License-Identifier: GPL-3.0-or-later

// Ear clipping with integer coordinates.
//
// Let w(x) be the winding number of a polygon around a point x of the plane, and assume w = 1
// inside and w = 0 elsewhere. An ear is a corner b between a and c such that a, b, c turn left, no
// edge of the polygon intersects the open triangle abc, and w = 1 there. Then w is constant in the
// triangle, and the polygon without b has the winding number w - 1 there and w elsewhere: again 1
// or 0. So the clipped triangles are disjoint and cover the inside. A simple polygon has two ears
// (Meisters 1975). So does a limit of simple polygons, such as one with bridges to its holes: in
// the limit, their ears become ears, or corners with a, b, c on a line, whose removal does not
// change the winding number.
#include "prefilter/geometry/polygon_triangles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

using Triangle = std::array<std::int64_t, 3>;

/// Coordinates are below 2^28 in magnitude: three times a difference is below 2^31, so that the
/// difference of two products of these is below 2^63.
struct GridPoint {
  std::int64_t x;
  std::int64_t y;

  bool operator==(const GridPoint&) const = default;
};
constexpr int kGridBits = 28;

/// Twice the signed area of a triangle, positive for a left turn.
std::int64_t doubled_area(GridPoint a, GridPoint b, GridPoint c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Newell's normal: its components are twice the areas of the polygon's projections.
Vector3 newell_normal(std::span<const Vector3> points) {
  Vector3 normal{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    normal = normal + cross(points[i], points[(i + 1) % points.size()]);
  }
  return normal;
}

/// Projects along the largest component of the normal to the plane of the other two axes, so that
/// the polygon winds counterclockwise.
std::vector<GridPoint> project_to_plane(std::span<const Vector3> points) {
  const Vector3 normal = newell_normal(points);
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a) {
    if (std::abs(normal[a]) > std::abs(normal[axis])) axis = a;
  }
  std::size_t u = (axis + 1) % 3;
  std::size_t v = (axis + 2) % 3;
  if (normal[axis] < 0.0) std::swap(u, v);
  const bool is_flat = normal[axis] != 0.0 && std::isfinite(normal[axis]);
  const double slope_u = is_flat ? normal[u] / normal[axis] : 0.0;
  const double slope_v = is_flat ? normal[v] / normal[axis] : 0.0;
  std::vector<std::array<double, 2>> plane;
  double extent = 0.0;
  for (const Vector3& point : points) {
    plane.push_back({point[u] - point[axis] * slope_u, point[v] - point[axis] * slope_v});
    extent = std::max({extent, std::abs(plane.back()[0]), std::abs(plane.back()[1])});
  }
  std::vector<GridPoint> grid(points.size(), GridPoint{0, 0});
  if (!(extent > 0.0 && std::isfinite(extent))) return grid;
  // A power of two, so that coordinates with few digits remain exact.
  const int shift = kGridBits - 1 - std::ilogb(extent);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid[i] = {std::llrint(std::ldexp(plane[i][0], shift)),
               std::llrint(std::ldexp(plane[i][1], shift))};
  }
  return grid;
}

class EarClipper {
 public:
  explicit EarClipper(std::vector<GridPoint> points) : points_(std::move(points)) {
    const std::size_t count = points_.size();
    for (std::size_t i = 0; i < count; ++i) {
      next_.push_back((i + 1) % count);
      previous_.push_back((i + count - 1) % count);
    }
    blocking_.resize(count, {kNone, kNone});
    left_ = count;
  }

  /// The triangles as indices of the polygon's corners.
  std::vector<std::array<std::size_t, 3>> clip() {
    std::vector<std::array<std::size_t, 3>> triangles;
    std::size_t corner = 1;
    while (left_ > 3) {
      corner = find(corner);
      triangles.push_back({previous_[corner], corner, next_[corner]});
      corner = remove(corner);
    }
    triangles.push_back({previous_[corner], corner, next_[corner]});
    return triangles;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  std::int64_t area_at(std::size_t corner) const {
    return doubled_area(points_[previous_[corner]], points_[corner], points_[next_[corner]]);
  }

  /// The best corner from `start` on. Ears whose third side passes through no corner are preferred,
  /// as they do not leave behind triangles without area.
  std::size_t find(std::size_t start) {
    std::size_t ear = kNone;
    std::size_t flat = kNone;
    std::size_t convex = kNone;
    std::size_t corner = start;
    do {
      const std::int64_t area = area_at(corner);
      if (area > 0) {
        if (convex == kNone) convex = corner;
        if (is_ear(corner)) {
          if (!passes_corner(corner)) return corner;
          if (ear == kNone) ear = corner;
        }
      } else if (area == 0 && flat == kNone) {
        flat = corner;
      }
      corner = next_[corner];
    } while (corner != start);
    if (flat != kNone) return flat;
    if (ear != kNone) return ear;
    // Only reached by self-crossing polygons; removing any corner preserves the signed area.
    return convex != kNone ? convex : start;
  }

  /// Returns the corner after the removed one.
  std::size_t remove(std::size_t corner) {
    const std::size_t before = previous_[corner];
    const std::size_t after = next_[corner];
    next_[before] = after;
    previous_[after] = before;
    next_[corner] = kNone;
    blocking_[before] = blocking_[after] = {kNone, kNone};
    --left_;
    return after;
  }

  bool is_ear(std::size_t corner) {
    const auto [begin, end] = blocking_[corner];
    // An edge that intersected the triangle before still does, until one of its ends is removed.
    if (begin != kNone && next_[begin] == end) return false;
    const std::size_t edge = edge_through(corner);
    blocking_[corner] = {edge, edge == kNone ? kNone : next_[edge]};
    return edge == kNone && winding_in(corner) == 1;
  }

  /// The start of an edge that intersects the open triangle at a corner; kNone without one.
  std::size_t edge_through(std::size_t corner) const {
    const GridPoint a = points_[previous_[corner]];
    const GridPoint b = points_[corner];
    const GridPoint c = points_[next_[corner]];
    const auto [low_x, high_x] = std::minmax({a.x, b.x, c.x});
    const auto [low_y, high_y] = std::minmax({a.y, b.y, c.y});
    for (std::size_t i = next_[corner]; i != previous_[corner]; i = next_[i]) {
      const GridPoint p = points_[i];
      const GridPoint q = points_[next_[i]];
      if (std::max(p.x, q.x) <= low_x || std::min(p.x, q.x) >= high_x) continue;
      if (std::max(p.y, q.y) <= low_y || std::min(p.y, q.y) >= high_y) continue;
      if (meets_inside(a, b, c, p, q)) return i;
    }
    return kNone;
  }

  /// Whether a segment intersects an open, counterclockwise triangle. Two convex sets in the plane
  /// are disjoint exactly if a line through a side of one of them separates them.
  static bool meets_inside(GridPoint a, GridPoint b, GridPoint c, GridPoint p, GridPoint q) {
    if (doubled_area(a, b, p) <= 0 && doubled_area(a, b, q) <= 0) return false;
    if (doubled_area(b, c, p) <= 0 && doubled_area(b, c, q) <= 0) return false;
    if (doubled_area(c, a, p) <= 0 && doubled_area(c, a, q) <= 0) return false;
    const auto [low, high] =
        std::minmax({doubled_area(p, q, a), doubled_area(p, q, b), doubled_area(p, q, c)});
    return p == q || (low < 0 && high > 0);
  }

  /// Whether a corner lies on the open side that removing a corner would create.
  bool passes_corner(std::size_t corner) const {
    const GridPoint a = points_[previous_[corner]];
    const GridPoint c = points_[next_[corner]];
    const auto [low_x, high_x] = std::minmax(a.x, c.x);
    const auto [low_y, high_y] = std::minmax(a.y, c.y);
    for (std::size_t i = next_[next_[corner]]; i != previous_[corner]; i = next_[i]) {
      const GridPoint p = points_[i];
      if (p.x < low_x || p.x > high_x || p.y < low_y || p.y > high_y) continue;
      if (p != a && p != c && doubled_area(a, c, p) == 0) return true;
    }
    return false;
  }

  /// The winding number in the triangle at an ear, which no edge crosses, evaluated at its center;
  /// coordinates are multiplied by 3.
  std::int64_t winding_in(std::size_t corner) const {
    const GridPoint a = points_[previous_[corner]];
    const GridPoint b = points_[corner];
    const GridPoint c = points_[next_[corner]];
    const GridPoint middle{a.x + b.x + c.x, a.y + b.y + c.y};
    std::int64_t winding = 0;
    std::size_t i = corner;
    do {
      const GridPoint p{3 * points_[i].x, 3 * points_[i].y};
      const GridPoint q{3 * points_[next_[i]].x, 3 * points_[next_[i]].y};
      if (p.y <= middle.y && q.y > middle.y) {
        winding += doubled_area(p, q, middle) > 0 ? 1 : 0;
      } else if (p.y > middle.y && q.y <= middle.y) {
        winding -= doubled_area(p, q, middle) < 0 ? 1 : 0;
      }
      i = next_[i];
    } while (i != corner);
    return winding;
  }

  std::vector<GridPoint> points_;
  std::vector<std::size_t> next_;
  std::vector<std::size_t> previous_;
  std::vector<std::pair<std::size_t, std::size_t>> blocking_;
  std::size_t left_ = 0;
};

void check_polygons(const PositionView& positions, std::span<const std::int64_t> corners,
                    std::span<const std::int64_t> sizes) {
  for (const std::int64_t vertex : corners) {
    if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= positions.size()) {
      throw_invalid("corners: found vertex " + std::to_string(vertex) + "; there are " +
                    std::to_string(positions.size()) + ", numbered from 0");
    }
  }
  std::uint64_t sum = 0;
  for (const std::int64_t size : sizes) {
    if (size < 0 || static_cast<std::uint64_t>(size) > corners.size() - sum) {
      throw_invalid("sizes: found " + std::to_string(size) + " after a sum of " +
                    std::to_string(sum) + "; there are " + std::to_string(corners.size()) +
                    " corners");
    }
    sum += static_cast<std::uint64_t>(size);
  }
  if (sum != corners.size()) {
    throw_invalid("sizes: their sum is " + std::to_string(sum) + "; there are " +
                  std::to_string(corners.size()) + " corners");
  }
}

}  // namespace

std::vector<Triangle> triangulate_polygons(const PositionView& positions,
                                           std::span<const std::int64_t> corners,
                                           std::span<const std::int64_t> sizes, const Run& run) {
  check_polygons(positions, corners, sizes);
  std::vector<Triangle> triangles;
  std::vector<Vector3> points;
  std::size_t first = 0;
  for (const std::int64_t signed_size : sizes) {
    const auto size = static_cast<std::size_t>(signed_size);
    const std::span<const std::int64_t> polygon = corners.subspan(first, size);
    const auto at = [&](std::size_t k) { return positions[static_cast<std::size_t>(polygon[k])]; };
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      if (at(a) == at(b) || at(b) == at(c) || at(c) == at(a)) return;
      const auto base = static_cast<std::int64_t>(first);
      triangles.push_back({base + static_cast<std::int64_t>(a), base + static_cast<std::int64_t>(b),
                           base + static_cast<std::int64_t>(c)});
    };
    if (size == 3) {
      add(0, 1, 2);
    } else if (size > 3) {
      points.clear();
      for (std::size_t k = 0; k < size; ++k) points.push_back(at(k) - at(0));
      for (const auto& [a, b, c] : EarClipper(project_to_plane(points)).clip()) add(a, b, c);
    }
    first += size;
    if (size > 0) run.report(static_cast<double>(first) / static_cast<double>(corners.size()));
  }
  return triangles;
}

}  // namespace prefilter
