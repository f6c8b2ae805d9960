// SPDX-License-Identifier: GPL-3.0-or-later

// Where a mesh goes: into arrays, into a file that is larger than memory.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Takes a mesh in pieces. Triangles name vertices by their place among all that were added.
class MeshSink {
 public:
  virtual ~MeshSink() = default;

  /// Attributes: for each vertex one value for each attribute of the points; none where the points
  /// have none.
  virtual void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) = 0;
  /// Triangles of vertices that were added before.
  virtual void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) = 0;
  /// A part is whole: of what has come, later triangles name those vertices that are `shared`, and
  /// no others. Not every mesh comes in parts.
  virtual void end_part(std::span<const std::int64_t> shared) { static_cast<void>(shared); }
};

}  // namespace prefilter
