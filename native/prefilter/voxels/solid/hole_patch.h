// SPDX-License-Identifier: GPL-3.0-or-later

// A patch over a hole: a disc of triangles that can be divided and flipped.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// Triangles over a loop, with what is beyond their edges. Edge i of a triangle runs from its
/// corner i to the next one. The first points are those of the loop, in its order, and the border
/// runs along it.
class HolePatch {
 public:
  static constexpr std::uint32_t kBorder = 0xFFFFFFFFU;

  struct Triangle {
    std::array<std::uint32_t, 3> corners;
    std::array<std::uint32_t, 3> beyond;  // the triangle across an edge, or kBorder
  };

  /// Of triangles that together are a disc. `normals`: the unit normals of the surface at each edge
  /// of the loop, zero where there is none.
  HolePatch(std::vector<Vector3> points, std::span<const std::array<std::uint32_t, 3>> triangles,
            std::vector<Vector3> normals);

  std::span<const Vector3> points() const { return points_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  void move_to(std::vector<Vector3> points) { points_ = std::move(points); }

  /// Twice the area, along the normal.
  Vector3 normal(std::uint32_t triangle) const;

  /// Adds a point and divides a triangle into the three around it.
  std::uint32_t divide(std::uint32_t triangle, const Vector3& point);

  /// Divides the triangle at a border edge; `point` is one that no triangle has yet.
  void divide_border(std::uint32_t triangle, int edge, std::uint32_t point);

  /// Makes triangles smaller, until no flip makes the two at an edge smaller; and among those of
  /// the same area flips to the greater smallest angle (Delaunay). What is folded back onto its
  /// neighbor, or onto the surface around, counts as larger. With `bends`, only by the
  /// angles, and across an edge where the patch bends by more than 60 degrees only if it is folded
  /// there. Looks at the edges of these triangles first, or at all of them.
  void flip(std::span<const std::uint32_t> first, bool bends, const Progress& progress);
  void flip_all(bool bends, const Progress& progress);

 private:
  void link(std::uint32_t triangle, int edge, std::uint32_t other, std::uint32_t was);
  bool has_edge(std::uint32_t triangle, int corner, std::uint32_t other) const;
  bool is_better_flipped(std::uint32_t triangle, int edge, bool bends) const;
  void flip_edge(std::uint32_t triangle, int edge);
  int edge_to(std::uint32_t triangle, std::uint32_t other) const;

  double fold_cost(std::uint32_t triangle, int edge, const Vector3& doubled) const;

  std::vector<Vector3> points_;
  std::vector<Vector3> normals_;
  std::vector<Triangle> triangles_;
};

/// What a triangle beside another one counts more, if both are folded onto each other; both by
/// twice their areas along their normals.
double fold_cost(const Vector3& doubled, const Vector3& other);

/// The corner of a triangle after one, in its order.
constexpr int next_corner(int corner) { return corner == 2 ? 0 : corner + 1; }
constexpr int previous_corner(int corner) { return corner == 0 ? 2 : corner - 1; }

}  // namespace prefilter
