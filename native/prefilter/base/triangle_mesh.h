// Triangles in space.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace prefilter {

/// Triangles that share vertices; counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

}  // namespace prefilter
