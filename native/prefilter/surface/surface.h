// A textured surface: triangles in space with texture coordinates.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace prefilter {

struct TextureCoordinate {
  double u = 0.0;
  double v = 0.0;
};

/// What filtering needs of a surface: where each triangle lies in the texture, and its area in
/// space.
struct Surface {
  std::vector<std::array<TextureCoordinate, 3>> uvs;   // per triangle and corner; any tile
  std::vector<double> areas;                           // per triangle, in squared units of space
  std::vector<std::array<double, 3>> positions;        // per vertex
  std::vector<std::array<std::int32_t, 3>> triangles;  // per triangle, its vertices

  std::size_t triangle_count() const { return areas.size(); }
  double total_area() const;
};

/// Raw arrays of a mesh, as a caller has them.
struct MeshArrays {
  const double* positions = nullptr;  // vertex_count x 3
  std::size_t vertex_count = 0;
  const std::int64_t* triangles = nullptr;  // triangle_count x 3 indices of vertices
  const double* uvs = nullptr;              // triangle_count x 3 corners x 2
  std::size_t triangle_count = 0;
};

/// Builds a surface. Triangles of zero area, in space or in the texture, are welcome, as are charts
/// that overlap, are mirrored, or leave the unit square. Throws Error for a mesh without triangles,
/// an index that names no vertex, positions or texture coordinates that are not finite, and
/// positions so large that an area overflows.
Surface make_surface(const MeshArrays& mesh);

}  // namespace prefilter
