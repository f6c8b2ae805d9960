// SPDX-License-Identifier: GPL-3.0-or-later

// G. Barill, N. Dickson, R. Schmidt, D. Levin, A. Jacobson, Fast winding numbers for soups and
// clouds (2018), first order. Solid angles: A. van Oosterom, J. Strackee, The solid angle of a
// plane triangle (1983).
#include "prefilter/geometry/spatial/winding_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "prefilter/base/elementary.h"
#include "prefilter/base/parallel.h"
#include "prefilter/geometry/spatial/curve_order.h"

namespace prefilter {
namespace {

constexpr std::size_t kTrianglesPerLeaf = 4;
constexpr std::int64_t kWindingsPerTask = 256;
constexpr double kMaxWindingCoordinate = 1e100;
// Relative determinant below which a point lies in the triangle's plane.
constexpr double kInPlane = 1e-12;
// Size of the stack of pending nodes: one per level of the tree, which has fewer.
constexpr std::size_t kMaxPendingNodes = 128;

// The solid angle of a triangle, as a fraction of the full sphere.
double solid_angle(const std::array<Vector3, 3>& triangle, const Vector3& point) {
  const Vector3 a = triangle[0] - point;
  const Vector3 b = triangle[1] - point;
  const Vector3 c = triangle[2] - point;
  const double la = plain_length(a);
  const double lb = plain_length(b);
  const double lc = plain_length(c);
  const double volume = dot(a, cross(b, c));
  if (std::abs(volume) <= kInPlane * la * lb * lc) return 0.0;
  const double denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return elementary::atan2(volume, denominator) / (2.0 * std::numbers::pi);
}

// The sign of a sum of products with magnitudes of `scale`; 0 within rounding errors.
int sign_of(double value, double scale) {
  constexpr double kRounding = 1e-9;
  return value > kRounding * scale ? 1 : value < -kRounding * scale ? -1 : 0;
}

bool may_meet(const std::array<Vector3, 3>& triangle, const Box& box) {
  const auto& [a, b, c] = triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::max({a[k], b[k], c[k]}) < box.low[k]) return false;
    if (std::min({a[k], b[k], c[k]}) > box.high[k]) return false;
  }
  return true;
}

// 1 if the segment leaves through the triangle, -1 if it enters, 0 if it misses it; nothing if
// uncertain.
std::optional<int> crossing_sign(const std::array<Vector3, 3>& triangle, const Vector3& from,
                                 const Vector3& to) {
  const auto& [a, b, c] = triangle;
  const Vector3 normal = cross(b - a, c - a);
  const double area = plain_length(normal);
  const double distance = plain_length(from - a) + plain_length(to - a);
  const int before = sign_of(dot(normal, from - a), area * distance);
  const int behind = sign_of(dot(normal, to - a), area * distance);
  if (before * behind > 0) return 0;
  const Vector3 way = to - from;
  std::array<int, 3> sides;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3 start = triangle[i] - from;
    const Vector3 side = triangle[(i + 1) % 3] - triangle[i];
    sides[i] = sign_of(dot(way, cross(start, side)),
                       plain_length(way) * plain_length(start) * plain_length(side));
  }
  const auto [least, most] = std::minmax({sides[0], sides[1], sides[2]});
  if (least * most < 0) return 0;
  if (least * most == 0 || before * behind == 0) return std::nullopt;
  return behind;
}

}  // namespace

WindingNumbers::WindingNumbers(const InputMesh& mesh, const Run& run) {
  check_mesh(mesh, kMaxWindingCoordinate);
  const auto middle_of = [&](std::size_t triangle) {
    const auto corners = mesh.corners(triangle);
    Vector3 middle = corners[0] + corners[1] + corners[2];
    for (double& x : middle) x /= 3.0;
    return middle;
  };
  const std::vector<CurvePlace> places =
      along_curve(mesh.triangles.size(), middle_of, run.part(0.0, 0.6));
  std::vector<std::uint64_t> keys;
  keys.reserve(places.size());
  triangles_.reserve(places.size());
  for (const CurvePlace& place : places) {
    keys.push_back(place.key);
    triangles_.push_back(mesh.corners(place.index));
  }
  const auto box_of = [&](std::size_t item) {
    Box box = kEmptyBox;
    for (const Vector3& corner : triangles_[item]) box.include(corner);
    return box;
  };
  tree_ = BoxTree(keys, kTrianglesPerLeaf, box_of, run.part(0.6, 0.9));
  far_fields_.resize(tree_.nodes().size());
  std::vector<double> areas(far_fields_.size());
  for (std::size_t n = far_fields_.size(); n-- > 0;) {
    if (n % (1U << 16U) == 0) run.report(0.9);
    far_fields_[n] = far_field_of(n, &areas);
  }
  run.report(1.0);
}

auto WindingNumbers::far_field_of(std::size_t n, std::vector<double>* areas) const -> FarField {
  const BoxTree::Node& node = tree_.nodes()[n];
  FarField far{};
  double area = 0.0;
  Vector3 sum{};
  const auto add = [&](const Vector3& middle, double weight) {
    area += weight;
    for (std::size_t a = 0; a < 3; ++a) sum[a] += weight * middle[a];
  };
  if (node.right == 0) {
    for (std::uint32_t item = node.begin; item < node.end; ++item) {
      const auto& [a, b, c] = triangles_[item];
      Vector3 normal = cross(b - a, c - a);
      for (double& x : normal) x /= 2.0;
      const Vector3 corners = a + b + c;
      add({corners[0] / 3.0, corners[1] / 3.0, corners[2] / 3.0}, plain_length(normal));
      far.normal = far.normal + normal;
    }
  } else {
    for (const std::size_t child : {n + 1, std::size_t{node.right}}) {
      add(far_fields_[child].middle, (*areas)[child]);
      far.normal = far.normal + far_fields_[child].normal;
    }
  }
  (*areas)[n] = area;
  for (std::size_t a = 0; a < 3; ++a) {
    far.middle[a] = area > 0.0 ? sum[a] / area : (node.box.low[a] + node.box.high[a]) / 2.0;
    const double reach =
        std::max(far.middle[a] - node.box.low[a], node.box.high[a] - far.middle[a]);
    far.squared_radius += reach * reach;
  }
  return far;
}

double WindingNumbers::at(const Vector3& point, double far_radii) const {
  const auto nodes = tree_.nodes();
  double winding = 0.0;
  std::array<std::uint32_t, kMaxPendingNodes> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t n = waiting[--count];
    const BoxTree::Node& node = nodes[n];
    const FarField& far = far_fields_[n];
    const Vector3 to = far.middle - point;
    const double squared = dot(to, to);
    if (squared > far_radii * far_radii * far.squared_radius) {
      winding += dot(far.normal, to) / (squared * std::sqrt(squared) * 4.0 * std::numbers::pi);
    } else if (node.right == 0) {
      for (std::uint32_t item = node.begin; item < node.end; ++item) {
        winding += solid_angle(triangles_[item], point);
      }
    } else {
      waiting[count++] = node.right;
      waiting[count++] = n + 1;
    }
  }
  return winding;
}

std::optional<double> WindingNumbers::excess(const Vector3& from, const Vector3& to) const {
  Box box = kEmptyBox;
  box.include(from);
  box.include(to);
  int sum = 0;
  bool is_sure = true;
  tree_.for_overlapping(box, [&](std::size_t node) {
    const BoxTree::Node& leaf = tree_.nodes()[node];
    for (std::uint32_t item = leaf.begin; is_sure && item < leaf.end; ++item) {
      if (!may_meet(triangles_[item], box)) continue;
      const std::optional<int> one = crossing_sign(triangles_[item], from, to);
      is_sure = one.has_value();
      sum += one.value_or(0);
    }
  });
  if (!is_sure) return std::nullopt;
  return sum;
}

std::vector<double> WindingNumbers::find(std::span<const Vector3> points, const Run& run) const {
  check_points(points, "points: row", kMaxWindingCoordinate);
  std::vector<double> result(points.size());
  parallel_ranges(static_cast<std::int64_t>(points.size()), kWindingsPerTask, run,
                  [&](std::int64_t begin, std::int64_t end) {
                    for (std::int64_t i = begin; i < end; ++i) {
                      result[static_cast<std::size_t>(i)] = at(points[static_cast<std::size_t>(i)]);
                    }
                  });
  return result;
}

}  // namespace prefilter
