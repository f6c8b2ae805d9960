// SPDX-License-Identifier: GPL-3.0-or-later

// A triangulated disk over a hole that supports refinement and edge flips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Triangles over a loop, with adjacency. Edge i of a triangle runs from corner i to the next one.
/// The first points are those of the loop, in order, and form the border.
class HolePatch {
 public:
  static constexpr std::uint32_t kBorder = 0xFFFFFFFFU;

  struct Triangle {
    std::array<std::uint32_t, 3> corners;
    std::array<std::uint32_t, 3> beyond;  // the triangle across an edge, or kBorder
  };

  /// The triangles must form a disk. `normals` holds the unit normals of the surface at the loop's
  /// edges, zero where there is none.
  HolePatch(std::vector<Vector3> points, std::span<const std::array<std::uint32_t, 3>> triangles,
            std::vector<Vector3> normals);

  std::span<const Vector3> points() const { return points_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  void move_to(std::vector<Vector3> points) { points_ = std::move(points); }

  /// Area vector times 2.
  Vector3 normal(std::uint32_t triangle) const;

  /// Adds a point and divides a triangle into three around it.
  std::uint32_t divide(std::uint32_t triangle, const Vector3& point);

  /// Divides the triangle at a border edge by `point`, which must not be used by any triangle yet.
  void divide_border(std::uint32_t triangle, int edge, std::uint32_t point);

  /// Flips edges until no flip reduces the area of the two triangles at an edge; at equal area,
  /// flips to the larger smallest angle (Delaunay). Triangles folded back onto a neighbor, or onto
  /// the surface around, count as larger. With `bends`, only angles count, and edges where the
  /// patch bends by more than 60 degrees are only flipped to remove folds. Starts with the edges of
  /// the given triangles, or with all.
  void flip(std::span<const std::uint32_t> first, bool bends, const Run& run);
  void flip_all(bool bends, const Run& run);

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

/// Additional cost of two adjacent triangles that are folded onto each other, given their area
/// vectors times 2.
double fold_cost(const Vector3& doubled, const Vector3& other);

/// The next corner of a triangle in its order.
constexpr int next_corner(int corner) { return corner == 2 ? 0 : corner + 1; }
constexpr int previous_corner(int corner) { return corner == 0 ? 2 : corner - 1; }

}  // namespace prefilter
