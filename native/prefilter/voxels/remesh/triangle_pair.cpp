// SPDX-License-Identifier: GPL-3.0-or-later

// Separates most pairs by planes in floating point. The others are decided by testing the edges of
// each triangle against the other one (T. Möller, A fast triangle-triangle intersection test,
// 1997), with orientation predicates (P. Guigue, O. Devillers, Fast and robust triangle-triangle
// overlap test using orientation predicates, 2003).
#include "prefilter/voxels/remesh/triangle_pair.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "prefilter/voxels/remesh/predicates.h"

namespace prefilter {
namespace {

using Points = std::array<Vector3, 3>;

// Error bounds are products of these sums: for each product of components in a sum, every rounding
// is at most 2^-53 of it.
double sum_of_sizes(const Vector3& v) { return std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]); }

constexpr double kProductError = 1e-15;        // rounded difference times a given vector
constexpr double kDeterminantError = 1.2e-15;  // determinant of rounded differences
constexpr double kNormalsError = 2e-15;        // product of two normals
// Smaller bounds may be denormal.
constexpr double kMinPairBound = 1e-280;

// Whether a vector has certainly negative products with two vectors, and positive ones with two
// others.
bool separates(const Vector3& direction, const Vector3& low_1, const Vector3& low_2,
               const Vector3& high_1, const Vector3& high_2) {
  const double sizes =
      sum_of_sizes(low_1) + sum_of_sizes(low_2) + sum_of_sizes(high_1) + sum_of_sizes(high_2);
  const double bound = kProductError * sizes * sum_of_sizes(direction);
  return bound > kMinPairBound && dot(direction, low_1) < -bound &&
         dot(direction, low_2) < -bound && dot(direction, high_1) > bound &&
         dot(direction, high_2) > bound;
}

// Whether all points of b are certainly beyond the plane through an edge of a, perpendicular to a.
bool is_beyond_edge(const Points& a, const Points& b) {
  const Vector3 normal = cross(a[1] - a[0], a[2] - a[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3& from = a[i];
    const Vector3 edge = a[(i + 1) % 3] - from;
    const Vector3 outward = cross(edge, normal);
    const Vector3 third = a[(i + 2) % 3] - from;
    const std::array<Vector3, 3> others = {b[0] - from, b[1] - from, b[2] - from};
    const double sizes = sum_of_sizes(edge) + sum_of_sizes(third) + sum_of_sizes(others[0]) +
                         sum_of_sizes(others[1]) + sum_of_sizes(others[2]);
    const double bound = kProductError * sizes * sum_of_sizes(outward);
    if (!(bound > kMinPairBound)) continue;
    const double reached = std::max({0.0, dot(outward, edge), dot(outward, third)}) + 3.0 * bound;
    if (std::all_of(others.begin(), others.end(),
                    [&](const Vector3& other) { return dot(outward, other) > reached; })) {
      return true;
    }
  }
  return false;
}

std::array<int, 3> sides_of(const Points& plane, const Points& points) {
  return {plane_side(plane[0], plane[1], plane[2], points[0]),
          plane_side(plane[0], plane[1], plane[2], points[1]),
          plane_side(plane[0], plane[1], plane[2], points[2])};
}

bool are_one_side(const std::array<int, 3>& sides) {
  return sides[0] != 0 && sides[0] == sides[1] && sides[0] == sides[2];
}

// Whether, by floating point, all points are certainly on the same side of the plane.
bool are_surely_one_side(const Points& plane, const Points& points) {
  const Vector3 u = plane[1] - plane[0];
  const Vector3 v = plane[2] - plane[0];
  const Vector3 normal = cross(u, v);
  const std::array<Vector3, 3> others = {points[0] - plane[0], points[1] - plane[0],
                                         points[2] - plane[0]};
  const double sizes =
      std::max({sum_of_sizes(others[0]), sum_of_sizes(others[1]), sum_of_sizes(others[2])});
  const double bound = kDeterminantError * sum_of_sizes(u) * sum_of_sizes(v) * sizes;
  if (!(bound > kMinPairBound)) return false;
  const Vector3 heights = {dot(normal, others[0]), dot(normal, others[1]), dot(normal, others[2])};
  return std::min({heights[0], heights[1], heights[2]}) > bound ||
         std::max({heights[0], heights[1], heights[2]}) < -bound;
}

// The axis along which the triangle's projection is largest, and not degenerate.
int view_axis(const Points& triangle) {
  const Vector3 normal = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  std::array<int, 3> axes = {0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int i, int j) {
    return std::abs(normal[static_cast<std::size_t>(i)]) >
           std::abs(normal[static_cast<std::size_t>(j)]);
  });
  for (const int axis : axes) {
    if (turn_along(axis, triangle[0], triangle[1], triangle[2]) != 0) return axis;
  }
  return axes[0];
}

// For a point in the triangle's plane.
bool is_in_triangle(int axis, const Points& triangle, const Vector3& point) {
  bool is_left = false;
  bool is_right = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const int turn = turn_along(axis, triangle[i], triangle[(i + 1) % 3], point);
    is_left = is_left || turn > 0;
    is_right = is_right || turn < 0;
  }
  return !(is_left && is_right);
}

// For collinear points: whether `point` lies on the segment from a to b.
bool is_between(const Vector3& a, const Vector3& b, const Vector3& point) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (point[i] < std::min(a[i], b[i]) || point[i] > std::max(a[i], b[i])) return false;
  }
  return true;
}

bool do_segments_intersect(int axis, const Vector3& a, const Vector3& b, const Vector3& c,
                           const Vector3& d) {
  const int c_turn = turn_along(axis, a, b, c);
  const int d_turn = turn_along(axis, a, b, d);
  const int a_turn = turn_along(axis, c, d, a);
  const int b_turn = turn_along(axis, c, d, b);
  if (c_turn * d_turn < 0 && a_turn * b_turn < 0) return true;
  return (c_turn == 0 && is_between(a, b, c)) || (d_turn == 0 && is_between(a, b, d)) ||
         (a_turn == 0 && is_between(c, d, a)) || (b_turn == 0 && is_between(c, d, b));
}

// Whether a segment in the plane of a triangle intersects it.
bool segment_intersects_in_plane(const Points& triangle, const Vector3& from, const Vector3& to) {
  const int axis = view_axis(triangle);
  if (is_in_triangle(axis, triangle, from)) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    if (do_segments_intersect(axis, triangle[i], triangle[(i + 1) % 3], from, to)) return true;
  }
  return false;
}

// Whether a segment intersects a triangle, given the sides on which its ends lie.
bool segment_intersects(const Points& triangle, const Vector3& from, int from_side,
                        const Vector3& to, int to_side) {
  if (from_side * to_side > 0) return false;
  if (from_side == 0 && to_side == 0) return segment_intersects_in_plane(triangle, from, to);
  bool is_left = false;
  bool is_right = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const int side = plane_side(from, to, triangle[i], triangle[(i + 1) % 3]);
    is_left = is_left || side > 0;
    is_right = is_right || side < 0;
  }
  return !(is_left && is_right);
}

bool do_edges_intersect(const Points& triangle, const Points& edges,
                        const std::array<int, 3>& sides) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (segment_intersects(triangle, edges[i], sides[i], edges[j], sides[j])) return true;
  }
  return false;
}

bool do_unconnected_intersect(const Points& a, const Points& b) {
  if (are_surely_one_side(a, b) || are_surely_one_side(b, a)) return false;
  if (is_beyond_edge(a, b) || is_beyond_edge(b, a)) return false;
  const std::array<int, 3> b_sides = sides_of(a, b);
  if (are_one_side(b_sides)) return false;
  const std::array<int, 3> a_sides = sides_of(b, a);
  if (are_one_side(a_sides)) return false;
  return do_edges_intersect(a, b, b_sides) || do_edges_intersect(b, a, a_sides);
}

// Whether a slightly tilted plane through an edge of the first triangle certainly separates the
// second; both have a corner at the origin.
bool are_separated_along_edge(const Vector3& a1, const Vector3& a2, const Vector3& b1,
                              const Vector3& b2) {
  constexpr double kTilt = 1e-9;  // tangent of the angle
  const Vector3 normal = cross(a1, a2);
  const auto is_beside = [&](const Vector3& outward, const Vector3& edge) {
    const double tilt = kTilt * std::sqrt(dot(outward, outward) / dot(edge, edge));
    return separates(outward - tilt * edge, a1, a2, b1, b2);
  };
  return is_beside(cross(a1, normal), a1) || is_beside(cross(normal, a2), a2);
}

// For triangles that share a corner: their intersection is convex, so if it is more than the
// corner, it reaches the opposite edge of one of them.
bool do_intersect_beyond_corner(const Points& a, std::size_t a_place, const Points& b,
                                std::size_t b_place) {
  const Vector3& corner = a[a_place];
  const Vector3& a1 = a[(a_place + 1) % 3];
  const Vector3& a2 = a[(a_place + 2) % 3];
  const Vector3& b1 = b[(b_place + 1) % 3];
  const Vector3& b2 = b[(b_place + 2) % 3];
  const Vector3 a1_out = a1 - corner;
  const Vector3 a2_out = a2 - corner;
  const Vector3 b1_out = b1 - corner;
  const Vector3 b2_out = b2 - corner;
  // Try planes between the triangles, which suit triangles around a vertex of a surface.
  const Vector3 middle = a1_out + a2_out;
  const Vector3 other_middle = b1_out + b2_out;
  if (separates(other_middle - middle, a1_out, a2_out, b1_out, b2_out)) return false;
  const double scale = std::sqrt(dot(middle, middle));
  const double other_scale = std::sqrt(dot(other_middle, other_middle));
  Vector3 direction;
  for (std::size_t i = 0; i < 3; ++i) {
    direction[i] = other_middle[i] * scale - middle[i] * other_scale;
  }
  if (separates(direction, a1_out, a2_out, b1_out, b2_out)) return false;
  if (are_separated_along_edge(a1_out, a2_out, b1_out, b2_out)) return false;
  if (are_separated_along_edge(b1_out, b2_out, a1_out, a2_out)) return false;
  const int b1_side = plane_side(corner, a1, a2, b1);
  const int b2_side = plane_side(corner, a1, a2, b2);
  if (b1_side * b2_side > 0) return false;
  const int a1_side = plane_side(corner, b1, b2, a1);
  const int a2_side = plane_side(corner, b1, b2, a2);
  if (a1_side * a2_side > 0) return false;
  return segment_intersects({corner, a1, a2}, b1, b1_side, b2, b2_side) ||
         segment_intersects({corner, b1, b2}, a1, a1_side, a2, a2_side);
}

// For triangles that share an edge, given their other corners.
bool do_fold_over(const Vector3& from, const Vector3& to, const Vector3& a, const Vector3& b) {
  const Vector3 edge = to - from;
  const Vector3 a_out = a - from;
  const Vector3 b_out = b - from;
  // Whether the corners are on different sides of a plane through the edge.
  const double size = sum_of_sizes(edge);
  const double bound = kNormalsError * size * size * sum_of_sizes(a_out) * sum_of_sizes(b_out);
  if (bound > kMinPairBound && dot(cross(edge, a_out), cross(b_out, edge)) > bound) return false;
  if (plane_side(from, to, a, b) != 0) return false;
  const int axis = view_axis({from, to, a});
  return turn_along(axis, from, to, a) == turn_along(axis, from, to, b);
}
}  // namespace

bool do_intersect(const Corners& a, const Corners& b) {
  // Bit 3 i + j: corner i of a and corner j of b are the same vertex.
  unsigned shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      shared |= (a.vertices[i] == b.vertices[j] ? 1U : 0U) << (3 * i + j);
    }
  }
  if (shared == 0) return do_unconnected_intersect(a.points, b.points);
  const auto first = static_cast<std::size_t>(std::countr_zero(shared));
  if (std::has_single_bit(shared)) {
    return do_intersect_beyond_corner(a.points, first / 3, b.points, first % 3);
  }
  shared &= shared - 1U;
  if (!std::has_single_bit(shared)) return true;
  const auto second = static_cast<std::size_t>(std::countr_zero(shared));
  return do_fold_over(a.points[first / 3], a.points[second / 3],
                      a.points[3 - first / 3 - second / 3], b.points[3 - first % 3 - second % 3]);
}

}  // namespace prefilter
