// SPDX-License-Identifier: GPL-3.0-or-later

// Simplifies a part of a mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

inline std::size_t as_index(std::int32_t i) { return static_cast<std::size_t>(i); }

/// A triangle, with bounds on its distance from the original surface.
struct PatchTriangle {
  std::array<std::int32_t, 3> corners{};
  /// Bit i: the side from corner i to the next one is a crease.
  std::uint8_t creases = 0;
  /// Distance of the original surface here from the triangles and `points` that represent it.
  float error = 0.0F;
  /// Maximum distance of these points, and of the surface between them, from the triangle.
  float deviation = 0.0F;
  /// The same for creases along the sides.
  std::array<float, 3> crease_errors{};
  /// First of the points of the original surface near this triangle; -1: none.
  std::int32_t first_point = -1;
  std::int32_t label = 0;
  bool is_new = false;  // whether a corner was moved
};

struct PatchPoint {
  Vector3 position;
  std::int32_t next;  // next point of the same triangle, or -1
};

/// A part of a mesh whose vertices are removed one by one, by collapsing edges onto their other
/// ends. All lengths are in units of the tolerance.
struct Patch {
  enum VertexFlags : std::uint8_t {
    kShared = 1,   // has triangles outside the patch; stays
    kFixed = 2,    // stays
    kPending = 4,  // may be removable: not tried since its surroundings changed
  };

  std::vector<Vector3> positions;
  std::vector<std::uint8_t> flags;  // of vertices
  std::vector<PatchTriangle> triangles;
  std::vector<PatchPoint> points;
  /// For each vertex the one it was collapsed onto; -1 for remaining vertices.
  std::vector<std::int32_t> targets;

  /// Approximate distance between points of the original surface.
  double spacing = 0.0;

  const Vector3& point(std::int32_t vertex) const { return positions[as_index(vertex)]; }
  bool is_shared(std::int32_t vertex) const { return (flags[as_index(vertex)] & kShared) != 0; }
  const PatchTriangle& triangle(std::int32_t t) const { return triangles[as_index(t)]; }
  PatchTriangle& triangle(std::int32_t t) { return triangles[as_index(t)]; }
};

/// Removes vertices where possible. Removed triangles have equal first and second corners.
void simplify_patch(Patch* patch);

}  // namespace prefilter
