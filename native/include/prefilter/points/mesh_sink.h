// SPDX-License-Identifier: GPL-3.0-or-later

// Interface for writing a mesh: into arrays, or into a file larger than memory.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Receives a mesh in pieces. Triangles refer to vertices by their index among all vertices added.
class MeshSink {
 public:
  virtual ~MeshSink() = default;

  /// `attributes` has for each vertex one value per attribute; empty if the points have none.
  virtual void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) = 0;
  /// Adds triangles of vertices that were added before.
  virtual void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) = 0;
  /// Marks the end of a part: of the vertices added so far, later triangles use only those in
  /// `shared`. Not every mesh is divided into parts.
  virtual void end_part(std::span<const std::int64_t> shared) { static_cast<void>(shared); }
};

}  // namespace prefilter
