// SPDX-License-Identifier: GPL-3.0-or-later

// Local optimization by edge flips (C. Lawson, Software for C1 surface interpolation, 1977).
#include "prefilter/voxels/solid/hole_patch.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace prefilter {
namespace {

// Areas that differ by a smaller share count as equal.
constexpr double kSameAreaTolerance = 1e-7;
// Maximum number of flips per triangle; since areas and angles both count, flipping may not
// terminate otherwise.
constexpr std::size_t kMaxFlipsPerTriangle = 12;
// Cosine between the normals of triangles below which they are folded.
constexpr double kFoldCosine = -0.866;
constexpr double kFoldWeight = 2.0;
constexpr std::size_t kFlipsPerReport = 1U << 14U;

// Area vector times 2; coordinates are about 1 here.
Vector3 doubled_area(const Vector3& a, const Vector3& b, const Vector3& c) {
  return cross(b - a, c - a);
}

// Cotangent of the angle at a in triangle abc.
double cotangent(const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 u = b - a;
  const Vector3 v = c - a;
  return dot(u, v) / std::max(plain_length(cross(u, v)), 1e-300);
}

}  // namespace

double fold_cost(const Vector3& doubled, const Vector3& other) {
  const double size = plain_length(doubled);
  const double other_size = plain_length(other);
  return dot(doubled, other) < kFoldCosine * size * other_size
             ? kFoldWeight / 2.0 * std::min(size, other_size)
             : 0.0;
}

HolePatch::HolePatch(std::vector<Vector3> points,
                     std::span<const std::array<std::uint32_t, 3>> triangles,
                     std::vector<Vector3> normals)
    : points_(std::move(points)), normals_(std::move(normals)) {
  struct Side {
    std::uint64_t edge;
    std::uint32_t triangle;
    std::uint32_t index;
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    triangles_.push_back({triangles[t], {kBorder, kBorder, kBorder}});
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint64_t a = triangles[t][i];
      const std::uint64_t b = triangles[t][(i + 1) % 3];
      sides.push_back({(std::min(a, b) << 32U) | std::max(a, b), static_cast<std::uint32_t>(t), i});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle;
  });
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const Side& a = sides[i - 1];
    const Side& b = sides[i];
    if (a.edge != b.edge) continue;
    triangles_[a.triangle].beyond[a.index] = b.triangle;
    triangles_[b.triangle].beyond[b.index] = a.triangle;
  }
}

Vector3 HolePatch::normal(std::uint32_t triangle) const {
  const auto& [a, b, c] = triangles_[triangle].corners;
  return doubled_area(points_[a], points_[b], points_[c]);
}

int HolePatch::edge_to(std::uint32_t triangle, std::uint32_t other) const {
  const auto& beyond = triangles_[triangle].beyond;
  return beyond[0] == other ? 0 : beyond[1] == other ? 1 : 2;
}

// Links `triangle` to its neighbor `other`, which so far was linked to triangle `was`.
void HolePatch::link(std::uint32_t triangle, int edge, std::uint32_t other, std::uint32_t was) {
  triangles_[triangle].beyond[static_cast<std::size_t>(edge)] = other;
  if (other == kBorder) return;
  triangles_[other].beyond[static_cast<std::size_t>(edge_to(other, was))] = triangle;
}

std::uint32_t HolePatch::divide(std::uint32_t triangle, const Vector3& point) {
  const auto p = static_cast<std::uint32_t>(points_.size());
  points_.push_back(point);
  const Triangle old = triangles_[triangle];
  const auto& [a, b, c] = old.corners;
  const auto second = static_cast<std::uint32_t>(triangles_.size());
  const std::uint32_t third = second + 1;
  triangles_[triangle] = {{a, b, p}, {old.beyond[0], second, third}};
  triangles_.push_back({{b, c, p}, {kBorder, third, triangle}});
  triangles_.push_back({{c, a, p}, {kBorder, triangle, second}});
  link(second, 0, old.beyond[1], triangle);
  link(third, 0, old.beyond[2], triangle);
  return p;
}

void HolePatch::divide_border(std::uint32_t triangle, int edge, std::uint32_t point) {
  const Triangle old = triangles_[triangle];
  const auto i = static_cast<std::size_t>(edge);
  const auto j = static_cast<std::size_t>(next_corner(edge));
  const auto k = static_cast<std::size_t>(previous_corner(edge));
  assert(old.beyond[i] == kBorder);
  const auto added = static_cast<std::uint32_t>(triangles_.size());
  triangles_[triangle] = {{old.corners[i], point, old.corners[k]}, {kBorder, added, old.beyond[k]}};
  triangles_.push_back({{point, old.corners[j], old.corners[k]}, {kBorder, kBorder, triangle}});
  link(added, 1, old.beyond[j], triangle);
}

// Whether an edge connects a triangle's corner to another point.
bool HolePatch::has_edge(std::uint32_t triangle, int corner, std::uint32_t other) const {
  const std::uint32_t center = triangles_[triangle].corners[static_cast<std::size_t>(corner)];
  // Walk around the corner in one direction, and from the border in the other.
  for (const bool is_forward : {true, false}) {
    std::uint32_t at = triangle;
    int i = corner;
    for (;;) {
      const auto& corners = triangles_[at].corners;
      if (corners[static_cast<std::size_t>(next_corner(i))] == other ||
          corners[static_cast<std::size_t>(previous_corner(i))] == other) {
        return true;
      }
      const int edge = is_forward ? previous_corner(i) : i;
      at = triangles_[at].beyond[static_cast<std::size_t>(edge)];
      if (at == triangle) return false;
      if (at == kBorder) break;
      const auto& next = triangles_[at].corners;
      i = next[0] == center ? 0 : next[1] == center ? 1 : 2;
    }
  }
  return false;
}

// Fold cost of a triangle with the given area vector and the neighbor across an edge.
double HolePatch::fold_cost(std::uint32_t triangle, int edge, const Vector3& doubled) const {
  const Triangle& own = triangles_[triangle];
  const std::uint32_t other = own.beyond[static_cast<std::size_t>(edge)];
  if (other != kBorder) return prefilter::fold_cost(doubled, normal(other));
  // At the border, the adjacent surface counts as equally large.
  const Vector3& outer = normals_[own.corners[static_cast<std::size_t>(edge)]];
  const double size = plain_length(doubled);
  return prefilter::fold_cost(doubled, {size * outer[0], size * outer[1], size * outer[2]});
}

bool HolePatch::is_better_flipped(std::uint32_t triangle, int edge, bool bends) const {
  const Triangle& first_triangle = triangles_[triangle];
  const std::uint32_t other = first_triangle.beyond[static_cast<std::size_t>(edge)];
  if (other == kBorder) return false;
  const int back = edge_to(other, triangle);
  const Vector3& a = points_[first_triangle.corners[static_cast<std::size_t>(edge)]];
  const Vector3& b = points_[first_triangle.corners[static_cast<std::size_t>(next_corner(edge))]];
  const std::uint32_t tip = first_triangle.corners[static_cast<std::size_t>(previous_corner(edge))];
  const std::uint32_t far =
      triangles_[other].corners[static_cast<std::size_t>(previous_corner(back))];
  if (tip == far) return false;
  const Vector3& c = points_[tip];
  const Vector3& d = points_[far];
  const Vector3 first = doubled_area(a, b, c);
  const Vector3 second = doubled_area(b, a, d);
  const Vector3 third = doubled_area(a, d, c);
  const Vector3 fourth = doubled_area(b, c, d);
  const int ahead = next_corner(edge);
  const int behind = previous_corner(edge);
  const int far_ahead = next_corner(back);
  const int far_behind = previous_corner(back);
  const double before = (plain_length(first) + plain_length(second)) / 2.0 +
                        prefilter::fold_cost(first, second) + fold_cost(triangle, ahead, first) +
                        fold_cost(triangle, behind, first) + fold_cost(other, far_ahead, second) +
                        fold_cost(other, far_behind, second);
  const double after = (plain_length(third) + plain_length(fourth)) / 2.0 +
                       prefilter::fold_cost(third, fourth) + fold_cost(triangle, behind, third) +
                       fold_cost(other, far_ahead, third) + fold_cost(triangle, ahead, fourth) +
                       fold_cost(other, far_behind, fourth);
  const double angles = cotangent(c, a, b) + cotangent(d, a, b);
  bool is_better = false;
  if (bends) {
    is_better = angles < -1e-6 &&
                dot(first, second) > 0.5 * plain_length(first) * plain_length(second) &&
                dot(third, fourth) > 0.0 && after < 1.1 * before;
    // Unfolding flips are always allowed.
    is_better = is_better || (dot(first, second) < 0.0 && after < 0.999 * before);
  } else if (after < (1.0 - kSameAreaTolerance) * before) {
    is_better = true;
  } else {
    is_better =
        after < (1.0 + kSameAreaTolerance) * before && angles < -1e-6 && dot(third, fourth) > 0.0;
  }
  return is_better && !has_edge(triangle, previous_corner(edge), far);
}

void HolePatch::flip_edge(std::uint32_t triangle, int edge) {
  const std::uint32_t other = triangles_[triangle].beyond[static_cast<std::size_t>(edge)];
  const int back = edge_to(other, triangle);
  const Triangle first_triangle = triangles_[triangle];
  const Triangle two = triangles_[other];
  const auto i = static_cast<std::size_t>(edge);
  const auto j = static_cast<std::size_t>(next_corner(edge));
  const auto k = static_cast<std::size_t>(previous_corner(edge));
  const auto m = static_cast<std::size_t>(next_corner(back));
  const auto n = static_cast<std::size_t>(previous_corner(back));
  const std::uint32_t a = first_triangle.corners[i];
  const std::uint32_t b = first_triangle.corners[j];
  const std::uint32_t c = first_triangle.corners[k];
  const std::uint32_t d = two.corners[n];
  triangles_[triangle].corners = {a, d, c};
  triangles_[other].corners = {d, b, c};
  triangles_[triangle].beyond = {kBorder, other, first_triangle.beyond[k]};
  triangles_[other].beyond = {two.beyond[n], kBorder, triangle};
  link(triangle, 0, two.beyond[m], other);
  link(other, 1, first_triangle.beyond[j], triangle);
}

void HolePatch::flip(std::span<const std::uint32_t> first, bool bends, const Run& run) {
  std::vector<std::uint32_t> waiting(first.rbegin(), first.rend());
  std::size_t left = kMaxFlipsPerTriangle * triangles_.size();
  std::size_t visited = 0;
  while (!waiting.empty() && left > 0) {
    const std::uint32_t triangle = waiting.back();
    waiting.pop_back();
    if (++visited % kFlipsPerReport == 0) run.report(0.5);
    for (int edge = 0; edge < 3; ++edge) {
      if (!is_better_flipped(triangle, edge, bends)) continue;
      const std::uint32_t other = triangles_[triangle].beyond[static_cast<std::size_t>(edge)];
      flip_edge(triangle, edge);
      waiting.push_back(other);
      waiting.push_back(triangle);
      --left;
      break;
    }
  }
  run.report(1.0);
}

void HolePatch::flip_all(bool bends, const Run& run) {
  std::vector<std::uint32_t> all(triangles_.size());
  std::iota(all.begin(), all.end(), 0U);
  flip(all, bends, run);
}

}  // namespace prefilter
