// SPDX-License-Identifier: GPL-3.0-or-later

// Shrinking balls (J. Ma, S. W. Bae, S. Choi, 3D medial point approximation using nearest neighbors
// and the normal field, 2012).
#include "prefilter/voxels/inner_balls.h"

#include <algorithm>
#include <cmath>

#include "prefilter/geometry/spatial/curve_order.h"
#include "prefilter/geometry/spatial/triangle_pieces.h"
#include "prefilter/geometry/spatial/triangle_point.h"
#include "prefilter/voxels/opposed_bricks.h"

namespace prefilter {
namespace {

constexpr std::size_t kLeafItems = 4;
constexpr std::size_t kMaxListedTriangles = 128;  // list length beyond which the tree is searched
constexpr int kMaxShrinkSteps = 12;
constexpr double kShrinkTolerance = 1e-3;  // relative change of the radius at which iteration ends
constexpr double kSameRadiusTolerance = 0.02;  // in cells
constexpr double kBelowMinCosine =
    0.9;  // cosine between the normal and the direction from the other point

// A point slightly outside, so that the opposite face of a sheet is below it.
Vector3 just_outside(const Vector3& point, const Vector3& normal) {
  return point + kJustOutside * normal;
}

}  // namespace

InnerBalls::InnerBalls(const MeshView<std::int32_t>& mesh, std::span<const Vector3> normals,
                       const std::vector<std::uint32_t>& triangles, const Run& run)
    : mesh_(mesh), normals_(normals) {
  const Stages stages(run, {7, 3});
  const std::vector<CurvePlace> places = along_curve(
      triangles.size(), [&](std::size_t i) { return triangle_middle(mesh.corners(triangles[i])); },
      stages[0]);
  std::vector<std::uint64_t> keys;
  for (const CurvePlace& place : places) {
    keys.push_back(place.key);
    triangles_.push_back(triangles[place.index]);
  }
  tree_ = BoxTree(
      keys, kLeafItems, [&](std::size_t i) { return triangle_box(mesh.corners(triangles_[i])); },
      stages[1]);
  const std::span<const BoxTree::Node> nodes = tree_.nodes();
  directions_.resize(nodes.size(), 0);
  for (std::size_t node = nodes.size(); node-- > 0;) {
    if (nodes[node].right != 0) {
      directions_[node] = directions_[node + 1] | directions_[nodes[node].right];
      continue;
    }
    for (std::uint32_t i = nodes[node].begin; i < nodes[node].end; ++i) {
      directions_[node] |= direction_bit(normals[triangles_[i]]);
    }
  }
}

void InnerBalls::find_across(const std::array<Vector3, 3>& piece, const Vector3& normal,
                             double largest, Across* across) const {
  across->triangles.clear();
  across->has_more = false;
  const Vector3 middle = triangle_middle(piece);
  double reach = 0.0;
  for (const Vector3& corner : piece) reach = std::max(reach, length(corner - middle));
  reach += largest + kJustOutside;
  const Vector3 center = middle - (largest - kJustOutside) * normal;
  const std::uint64_t bits = bits_across(normal);
  const auto may_be = [&](double squared, std::size_t node) {
    return !across->has_more && squared <= reach * reach && (directions_[node] & bits) != 0;
  };
  tree_.search(center, may_be, [&](std::size_t node) {
    const BoxTree::Node& leaf = tree_.nodes()[node];
    for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) {
      const std::uint32_t t = triangles_[i];
      const double facing = dot(normals_[t], normal);
      if (facing > kAcross) continue;
      const std::array<Vector3, 3> corners = mesh_.corners(t);
      const Box box = triangle_box(corners);
      if (box.squared_distance(center) > reach * reach) continue;
      across->triangles.push_back({corners, box, normals_[t], facing});
    }
    across->has_more = across->triangles.size() > kMaxListedTriangles;
  });
}

std::optional<InnerBalls::Touched> InnerBalls::nearest_across(const Vector3& point, double reach,
                                                              const Vector3& normal,
                                                              const Across& across,
                                                              const Counts* counts) const {
  std::optional<Touched> touched;
  double best = reach * reach;
  const auto test_triangle = [&](const std::array<Vector3, 3>& corners, const Vector3& its,
                                 double facing) {
    const auto& [a, b, c] = corners;
    const Vector3 w = nearest_weights(point, a, b, c);
    const Vector3 p = w[0] * a + w[1] * b + w[2] * c;
    const Vector3 d = p - point;
    if (dot(d, d) >= best) return;
    if (counts != nullptr && !(*counts)(p, its)) return;
    best = dot(d, d);
    touched = {p, its, facing};
  };
  if (!across.has_more) {
    for (const Across::One& one : across.triangles) {
      if (one.box.squared_distance(point) < best)
        test_triangle(one.corners, one.normal, one.facing);
    }
    return touched;
  }
  const std::uint64_t bits = bits_across(normal);
  const auto may_be = [&](double squared, std::size_t node) {
    return squared < best && (directions_[node] & bits) != 0;
  };
  tree_.search(point, may_be, [&](std::size_t node) {
    const BoxTree::Node& leaf = tree_.nodes()[node];
    for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) {
      const std::uint32_t t = triangles_[i];
      const double facing = dot(normals_[t], normal);
      if (facing <= kAcross) test_triangle(mesh_.corners(t), normals_[t], facing);
    }
  });
  return touched;
}

InnerBalls::Shrunk InnerBalls::shrunk(const Vector3& start, const Vector3& normal, double largest,
                                      const Across& across, const Counts* counts) const {
  Shrunk result = {{largest, 0.0, 0.0}, {}};
  InnerBall& ball = result.ball;
  for (int step = 0; step < kMaxShrinkSteps; ++step) {
    const double reach = ball.radius * (1.0 - kShrinkTolerance) - 0.1 * kJustOutside;
    if (!(reach > 0.0)) break;
    const std::optional<Touched> touched =
        nearest_across(start - ball.radius * normal, reach, normal, across, counts);
    if (!touched) break;
    const Vector3 away = start - touched->point;
    const double depth = dot(away, normal);
    if (!(depth > 0.0)) break;
    ball.facing = std::min(ball.facing, touched->facing);
    ball.across = touched->facing;
    ball.radius = dot(away, away) / (2.0 * depth);
    result.touched = *touched;
  }
  return result;
}

std::optional<InnerBall> InnerBalls::at(const Vector3& point, const Vector3& normal, double largest,
                                        const Across& across, const IsOuter& is_outer) const {
  const Vector3 start = just_outside(point, normal);
  const auto counts = [&](const Vector3& p, const Vector3& its) {
    const Vector3 away = start - p;
    return dot(away, normal) >= kBelowMinCosine * length(away) || is_outer(p, its);
  };
  Shrunk found = shrunk(start, normal, largest, across, nullptr);
  // Filter only when needed, since is_outer is expensive.
  if (found.ball.radius < largest && !counts(found.touched.point, found.touched.normal)) {
    const Counts only_these = counts;
    found = shrunk(start, normal, largest, across, &only_these);
  }
  if (found.ball.radius >= largest) return std::nullopt;
  found.ball.radius = std::max(0.0, found.ball.radius - kJustOutside / 2.0);
  return found.ball;
}

bool InnerBalls::are_alike(const std::array<Vector3, 3>& piece, const Vector3& normal,
                           double largest, const Across& across) const {
  const Vector3 middle = triangle_middle(piece);
  const auto radius_at = [&](const Vector3& point) {
    return shrunk(just_outside(point, normal), normal, largest, across, nullptr).ball.radius;
  };
  const double first = radius_at(middle);
  if (first >= largest) return false;
  for (const Vector3& corner : piece) {
    for (const double share : {0.5, 0.95}) {
      const double radius = radius_at(middle + share * (corner - middle));
      if (radius >= largest || std::abs(radius - first) > kSameRadiusTolerance) return false;
    }
  }
  return true;
}

}  // namespace prefilter
