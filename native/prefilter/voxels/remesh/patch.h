// SPDX-License-Identifier: GPL-3.0-or-later

// A part of a mesh whose triangles become fewer.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

inline std::size_t as_index(std::int32_t i) { return static_cast<std::size_t>(i); }

/// A triangle, and how well it stands for the surface that was there.
struct PatchTriangle {
  std::array<std::int32_t, 3> corners{};
  /// Bit i: the side from corner i to the next one is a crease.
  std::uint8_t creases = 0;
  /// What the surface given up here is away from the triangles and `points` that stand for it.
  float error = 0.0F;
  /// How far that, and what lies between it, may be from the triangle.
  float deviation = 0.0F;
  /// The same of creases along sides.
  std::array<float, 3> crease_errors{};
  /// The first of the points of the surface that were given up, and lie near this triangle; -1:
  /// none.
  std::int32_t first_point = -1;
  std::int32_t label = 0;
  bool is_new = false;  // a corner has moved
};

struct PatchPoint {
  Vector3 position;
  std::int32_t next;  // of the same triangle, or -1
};

/// Vertices are removed, one after the other, by collapsing edges onto their other ends. All
/// lengths are in units of the tolerance.
struct Patch {
  enum VertexFlags : std::uint8_t {
    kShared = 1,   // has triangles that are not part of the patch; stays
    kKept = 2,     // stays
    kWaiting = 4,  // may be removable: surroundings have changed since that was tried
  };

  std::vector<Vector3> positions;
  std::vector<std::uint8_t> flags;  // of vertices
  std::vector<PatchTriangle> triangles;
  std::vector<PatchPoint> points;
  /// For each vertex the one that it was collapsed onto; -1 for those that are there.
  std::vector<std::int32_t> targets;

  /// About how far points of the surface that was there are apart.
  double spacing = 0.0;

  const Vector3& point(std::int32_t vertex) const { return positions[as_index(vertex)]; }
  bool is_shared(std::int32_t vertex) const { return (flags[as_index(vertex)] & kShared) != 0; }
  const PatchTriangle& triangle(std::int32_t t) const { return triangles[as_index(t)]; }
  PatchTriangle& triangle(std::int32_t t) { return triangles[as_index(t)]; }
};

/// Removes what can be removed. Triangles that are gone have their first corner twice.
void simplify_patch(Patch* patch);

}  // namespace prefilter
