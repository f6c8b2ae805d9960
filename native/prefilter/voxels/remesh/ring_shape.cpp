// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/ring_shape.h"

#include <algorithm>
#include <cmath>

#include "prefilter/voxels/remesh/measured_triangle.h"

namespace prefilter {
namespace {

// minimum height, relative to the longest side, of a triangle that is no sliver
constexpr double kMaxSliverRatio = 0.1;
constexpr double kMinTriangleHeight = 1.0;  // in tolerances
constexpr double kBentCosine = 0.85;        // 32 degrees

void measure_triangles(const Patch& patch, std::int32_t vertex, const Ring& ring,
                       RingShape* shape) {
  shape->error = 0.0;
  shape->deviation = 0.0;
  shape->has_points = false;
  shape->squared_height = kMinTriangleHeight * kMinTriangleHeight;
  const Vector3& at = patch.point(vertex);
  for (std::size_t i = 0; i < ring.size; ++i) {
    const PatchTriangle& t = patch.triangle(ring.triangles[i]);
    shape->error = std::max(shape->error, static_cast<double>(t.error));
    shape->deviation = std::max(shape->deviation, static_cast<double>(t.deviation));
    shape->has_points = shape->has_points || t.first_point >= 0;
    const Vector3 p = patch.point(ring.vertices[i]) - at;
    const Vector3 q = patch.point(ring.vertices[ring.next(i)]) - at;
    shape->normals[i] = cross(p, q);
    const double squared = squared_length(shape->normals[i]);
    shape->squared_normals[i] = squared;
    const double longest = std::max({squared_length(p), squared_length(q), squared_length(q - p)});
    shape->is_sliver[i] = !(squared > kMaxSliverRatio * kMaxSliverRatio * longest * longest);
    shape->squared_height =
        std::min(shape->squared_height, longest > 0.0 ? squared / longest : 0.0);
  }
}

// Assigns triangles to the sectors between two creases, and sums the normals of each sector.
void divide(const Ring& ring, RingShape* shape) {
  std::size_t start = 0;
  while (start < ring.size && !ring.is_crease[start]) ++start;
  if (start == ring.size) start = 0;
  std::size_t sector = 0;
  shape->sector_normals[0] = shape->sector_normals[1] = {};
  for (std::size_t i = 0; i < ring.size; ++i) {
    const std::size_t at = (start + i) % ring.size;
    if (i > 0 && ring.is_crease[at] && ring.crease_count == 2) sector = 1;
    shape->sectors[at] = static_cast<std::uint8_t>(sector);
    shape->sector_normals[sector] = shape->sector_normals[sector] + shape->normals[at];
  }
}

void measure_sectors(const Patch& patch, std::int32_t vertex, const Ring& ring, RingShape* shape) {
  const Vector3& at = patch.point(vertex);
  shape->range = 0.0;
  shape->is_bent = false;
  for (std::size_t s = 0; s < 2; ++s) {
    Vector3& normal = shape->sector_normals[s];
    const double size = std::sqrt(squared_length(normal));
    if (!(size > 0.0)) {
      normal = {};
      shape->is_bent = shape->is_bent || s == 0 || ring.crease_count == 2;
      continue;
    }
    normal = (1.0 / size) * normal;
    double low = 0.0;
    double high = 0.0;
    for (std::size_t i = 0; i < ring.size; ++i) {
      if (shape->sectors[i] != s) continue;
      shape->is_bent = shape->is_bent || !(dot(normal, shape->normals[i]) >=
                                           kBentCosine * std::sqrt(shape->squared_normals[i]));
      for (const std::size_t j : {i, ring.next(i)}) {
        const double height = dot(normal, patch.point(ring.vertices[j]) - at);
        low = std::min(low, height);
        high = std::max(high, height);
      }
    }
    shape->range = std::max(shape->range, high - low);
  }
}
}  // namespace

void measure_ring(const Patch& patch, std::int32_t vertex, const Ring& ring, RingShape* shape) {
  measure_triangles(patch, vertex, ring, shape);
  divide(ring, shape);
  measure_sectors(patch, vertex, ring, shape);
}

}  // namespace prefilter
