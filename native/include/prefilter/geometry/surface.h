// SPDX-License-Identifier: GPL-3.0-or-later

// A textured surface: triangles in space with texture coordinates.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

struct TextureCoordinate {
  double u = 0.0;
  double v = 0.0;
};

/// A surface for filters: the position of each triangle in the texture, and its area in space.
struct Surface {
  std::vector<std::array<TextureCoordinate, 3>> uvs;   // per triangle and corner; any tile
  std::vector<double> areas;                           // per triangle, in squared units of space,
                                                       // times its weight
  std::vector<Vector3> positions;                      // per vertex
  std::vector<std::array<std::int32_t, 3>> triangles;  // per triangle, its vertices

  std::size_t triangle_count() const { return areas.size(); }
  double total_area() const;
};

/// The mesh elements that weights belong to.
enum class WeightsOf { kNothing, kVertices, kTriangles, kCorners };

/// A mesh with texture coordinates, owned by the caller.
struct TexturedMesh {
  InputMesh mesh;
  const double* uvs = nullptr;      // triangles x 3 corners x 2
  const double* weights = nullptr;  // one per element of weights_of; 0 and up
  WeightsOf weights_of = WeightsOf::kNothing;
};

/// Builds a surface. Triangles may have zero area in space or in the texture, and charts may
/// overlap, be mirrored or leave the unit square. A triangle's area is multiplied by its weight, or
/// the mean of its three corners' weights. Throws Error for a mesh without triangles, an index out
/// of range, positions or texture coordinates that are not finite, negative or non-finite weights,
/// and positions or weights so large that an area overflows; Error(kCancelled).
Surface make_surface(const TexturedMesh& textured, const Run& run = Run());

/// The rows of a 3 x 4 matrix that maps (x, y, z, 1) to a point.
using AffineMap = std::array<std::array<double, 4>, 3>;

/// Instances a surface under arbitrary affine maps (including non-uniform, mirrored and flat ones):
/// each triangle has the total area of all its images. Positions are those of the first instance.
/// Throws Error without maps, and for a map that is not finite or so large that an area overflows.
Surface place_surface(const Surface& surface, std::span<const AffineMap> maps);

/// Whether two surfaces have the same triangles with the same texture coordinates, so that they
/// differ in space and weights only.
bool same_layout(const Surface& a, const Surface& b);

/// Adds the areas of a second surface with the same layout: an average over poses (section 7.5), up
/// to a factor that does not affect filters. Throws Error if an area overflows.
Surface add_areas(Surface surface, const Surface& other);

}  // namespace prefilter
