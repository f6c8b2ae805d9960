// Planes that separate most pairs are found in floating point. What is left is decided by the edges
// of each triangle that pass through the other one: Möller, A fast triangle-triangle intersection
// test (1997), with the orientation tests of Guigue and Devillers, Fast and robust
// triangle-triangle overlap test using orientation predicates (2003).
#include "prefilter/remesh/triangle_pair.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "prefilter/remesh/predicates.h"

namespace prefilter {
namespace {

using Points = std::array<Vector3, 3>;

double largest(const Vector3& v) {
  return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
}

// Of a sum of three products of rounded differences with given numbers: 5 roundings each.
constexpr double kErrorOfProduct = 3e-15;
// Bounds below this may have lost digits.
constexpr double kSmallestBound = 1e-280;

// Whether a vector has certainly negative products with two others, and positive ones with two
// more.
bool separates(const Vector3& direction, const Vector3& low_1, const Vector3& low_2,
               const Vector3& high_1, const Vector3& high_2) {
  const double size = std::max({largest(low_1), largest(low_2), largest(high_1), largest(high_2)});
  const double bound = kErrorOfProduct * size * largest(direction);
  return bound > kSmallestBound && dot(direction, low_1) < -bound &&
         dot(direction, low_2) < -bound && dot(direction, high_1) > bound &&
         dot(direction, high_2) > bound;
}

// Whether all points of b are certainly beyond an edge of a, in the plane of a or above and below
// it.
bool is_beyond_an_edge(const Points& a, const Points& b) {
  const Vector3 normal = cross(a[1] - a[0], a[2] - a[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3& from = a[i];
    const Vector3 edge = a[(i + 1) % 3] - from;
    const Vector3 outward = cross(edge, normal);
    const Vector3 third = a[(i + 2) % 3] - from;
    const std::array<Vector3, 3> others = {b[0] - from, b[1] - from, b[2] - from};
    const double size = std::max({largest(edge), largest(third), largest(others[0]),
                                  largest(others[1]), largest(others[2])});
    const double bound = kErrorOfProduct * size * largest(outward);
    if (!(bound > kSmallestBound)) continue;
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

// In floating point: certainly all on one side of the plane.
bool are_surely_one_side(const Points& plane, const Points& points) {
  const Vector3 u = plane[1] - plane[0];
  const Vector3 v = plane[2] - plane[0];
  const Vector3 normal = cross(u, v);
  const std::array<Vector3, 3> others = {points[0] - plane[0], points[1] - plane[0],
                                         points[2] - plane[0]};
  constexpr double kErrorOfThree = 8e-15;
  const double size = std::max({largest(others[0]), largest(others[1]), largest(others[2])});
  const double bound = kErrorOfThree * std::max(size, largest(u)) * std::max(size, largest(v)) *
                       std::max({size, largest(u), largest(v)});
  if (!(bound > kSmallestBound)) return false;
  const Vector3 heights = {dot(normal, others[0]), dot(normal, others[1]), dot(normal, others[2])};
  return std::min({heights[0], heights[1], heights[2]}) > bound ||
         std::max({heights[0], heights[1], heights[2]}) < -bound;
}

// The axis along which the triangle is seen as a triangle, and best.
int view_axis(const Points& triangle) {
  const Vector3 normal = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  std::array<int, 3> axes = {0, 1, 2};
  std::sort(axes.begin(), axes.end(), [&](int i, int j) {
    return std::abs(normal[static_cast<std::size_t>(i)]) >
           std::abs(normal[static_cast<std::size_t>(j)]);
  });
  for (const int axis : axes) {
    if (turn_along(axis, triangle[0], triangle[1], triangle[2]) != 0) return axis;
  }
  return axes[0];
}

// In the plane.
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

// Of points on one line: whether the last is between the others, or one of them.
bool is_between(const Vector3& a, const Vector3& b, const Vector3& point) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (point[i] < std::min(a[i], b[i]) || point[i] > std::max(a[i], b[i])) return false;
  }
  return true;
}

bool do_segments_meet(int axis, const Vector3& a, const Vector3& b, const Vector3& c,
                      const Vector3& d) {
  const int c_turn = turn_along(axis, a, b, c);
  const int d_turn = turn_along(axis, a, b, d);
  const int a_turn = turn_along(axis, c, d, a);
  const int b_turn = turn_along(axis, c, d, b);
  if (c_turn * d_turn < 0 && a_turn * b_turn < 0) return true;
  return (c_turn == 0 && is_between(a, b, c)) || (d_turn == 0 && is_between(a, b, d)) ||
         (a_turn == 0 && is_between(c, d, a)) || (b_turn == 0 && is_between(c, d, b));
}

// Whether a segment in the plane of a triangle meets it.
bool does_meet_in_plane(const Points& triangle, const Vector3& from, const Vector3& to) {
  const int axis = view_axis(triangle);
  if (is_in_triangle(axis, triangle, from)) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    if (do_segments_meet(axis, triangle[i], triangle[(i + 1) % 3], from, to)) return true;
  }
  return false;
}

// Whether a segment meets a triangle; given are the sides of its ends.
bool does_meet(const Points& triangle, const Vector3& from, int from_side, const Vector3& to,
               int to_side) {
  if (from_side * to_side > 0) return false;
  if (from_side == 0 && to_side == 0) return does_meet_in_plane(triangle, from, to);
  bool is_left = false;
  bool is_right = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const int side = plane_side(from, to, triangle[i], triangle[(i + 1) % 3]);
    is_left = is_left || side > 0;
    is_right = is_right || side < 0;
  }
  return !(is_left && is_right);
}

bool do_any_edges_meet(const Points& triangle, const Points& edges,
                       const std::array<int, 3>& sides) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (does_meet(triangle, edges[i], sides[i], edges[j], sides[j])) return true;
  }
  return false;
}

bool do_strangers_intersect(const Points& a, const Points& b) {
  if (are_surely_one_side(a, b) || are_surely_one_side(b, a)) return false;
  if (is_beyond_an_edge(a, b) || is_beyond_an_edge(b, a)) return false;
  const std::array<int, 3> b_sides = sides_of(a, b);
  if (are_one_side(b_sides)) return false;
  const std::array<int, 3> a_sides = sides_of(b, a);
  if (are_one_side(a_sides)) return false;
  return do_any_edges_meet(a, b, b_sides) || do_any_edges_meet(b, a, a_sides);
}

// Of triangles that share their first corner: what they have in common is convex, so that more than
// the corner reaches the opposite edge of one of them.
bool do_meet_at_a_corner(const Points& a, const Points& b) {
  const std::array<Vector3, 4> out = {a[1] - a[0], a[2] - a[0], b[1] - a[0], b[2] - a[0]};
  // A plane between the triangles, as they are around a vertex of a surface.
  const Vector3 middle = out[0] + out[1];
  const Vector3 other_middle = out[2] + out[3];
  const double scale = std::sqrt(dot(middle, middle));
  const double other_scale = std::sqrt(dot(other_middle, other_middle));
  Vector3 direction;
  for (std::size_t i = 0; i < 3; ++i) {
    direction[i] = other_middle[i] * scale - middle[i] * other_scale;
  }
  if (separates(direction, out[0], out[1], out[2], out[3])) return false;
  const int b_side_1 = plane_side(a[0], a[1], a[2], b[1]);
  const int b_side_2 = plane_side(a[0], a[1], a[2], b[2]);
  if (b_side_1 * b_side_2 > 0) return false;
  const int a_side_1 = plane_side(b[0], b[1], b[2], a[1]);
  const int a_side_2 = plane_side(b[0], b[1], b[2], a[2]);
  if (a_side_1 * a_side_2 > 0) return false;
  return does_meet(a, b[1], b_side_1, b[2], b_side_2) ||
         does_meet(b, a[1], a_side_1, a[2], a_side_2);
}

// Of triangles that share their first two corners.
bool do_fold_over(const Points& a, const Points& b) {
  const Vector3 edge = a[1] - a[0];
  const Vector3 a_out = a[2] - a[0];
  const Vector3 b_out = b[2] - a[0];
  // On different sides of a plane through the edge.
  const Vector3 a_normal = cross(edge, a_out);
  const Vector3 b_normal = cross(b_out, edge);
  const double size = std::max({largest(edge), largest(a_out), largest(b_out)});
  constexpr double kErrorOfNormals = 2e-14;
  const double bound = kErrorOfNormals * size * size * size * size;
  if (bound > kSmallestBound && dot(a_normal, b_normal) > bound) return false;
  if (plane_side(a[0], a[1], a[2], b[2]) != 0) return false;
  const int axis = view_axis(a);
  return turn_along(axis, a[0], a[1], a[2]) == turn_along(axis, a[0], a[1], b[2]);
}
}  // namespace

bool do_intersect(const Corners& a, const Corners& b) {
  Points p = a.points;
  Points q = b.points;
  std::array<std::int32_t, 3> p_vertices = a.vertices;
  std::array<std::int32_t, 3> q_vertices = b.vertices;
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = shared; j < 3; ++j) {
      if (p_vertices[i] != q_vertices[j]) continue;
      std::swap(p_vertices[shared], p_vertices[i]);
      std::swap(p[shared], p[i]);
      std::swap(q_vertices[shared], q_vertices[j]);
      std::swap(q[shared], q[j]);
      ++shared;
      break;
    }
  }
  switch (shared) {
    case 0:
      return do_strangers_intersect(p, q);
    case 1:
      return do_meet_at_a_corner(p, q);
    case 2:
      return do_fold_over(p, q);
    default:
      return true;
  }
}

}  // namespace prefilter
