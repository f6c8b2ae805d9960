// SPDX-License-Identifier: GPL-3.0-or-later

// A textured surface: triangles in space with texture coordinates.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

struct TextureCoordinate {
  double u = 0.0;
  double v = 0.0;
};

/// What filtering needs of a surface: where each triangle lies in the texture, and its area in
/// space.
struct Surface {
  std::vector<std::array<TextureCoordinate, 3>> uvs;   // per triangle and corner; any tile
  std::vector<double> areas;                           // per triangle, in squared units of space,
                                                       // times the weight that it was given
  std::vector<Vector3> positions;                      // per vertex
  std::vector<std::array<std::int32_t, 3>> triangles;  // per triangle, its vertices

  std::size_t triangle_count() const { return areas.size(); }
  double total_area() const;
};

/// What the weights of a mesh belong to.
enum class WeightsOf { kNothing, kVertices, kTriangles, kCorners };

/// A mesh with texture coordinates, as a caller has it.
struct TexturedMesh {
  InputMesh mesh;
  const double* uvs = nullptr;      // triangles x 3 corners x 2
  const double* weights = nullptr;  // one for each of weights_of; 0 and up
  WeightsOf weights_of = WeightsOf::kNothing;
};

/// Builds a surface. Triangles of zero area, in space or in the texture, are welcome, as are charts
/// that overlap, are mirrored, or leave the unit square. A triangle's area counts times its weight,
/// or the mean of its three corners' weights. Throws Error for a mesh without triangles, an index
/// that names no vertex, positions or texture coordinates that are not finite, weights that are
/// negative or not finite, and positions or weights so large that an area overflows;
/// Error(kCancelled).
Surface make_surface(const TexturedMesh& textured, const Progress& progress = Progress());

/// The rows of a 3 x 4 matrix that takes (x, y, z, 1) to a point.
using AffineMap = std::array<std::array<double, 4>, 3>;

/// A surface placed in space several times, by affine maps of any kind (non-uniform, mirrored,
/// flat): each triangle has the areas of all of its images together. Positions are those of the
/// first map. Throws Error where there is none, or one is not finite or so large that an area
/// overflows.
Surface place_surface(const Surface& surface, std::span<const AffineMap> maps);

/// Whether two surfaces have the same triangles with the same texture coordinates, so that they
/// differ in space and weights alone.
bool same_layout(const Surface& a, const Surface& b);

/// The first surface, with the areas of the second, which has the same layout, added to its own: an
/// average over poses (section 7.5), up to a factor that no filter sees. Throws Error where an area
/// overflows.
Surface add_areas(Surface surface, const Surface& other);

}  // namespace prefilter
