// SPDX-License-Identifier: GPL-3.0-or-later

// Vertices of a contour whose lines miss the surface that they represent.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour/feature_surface.h"
#include "prefilter/voxels/contour/sharp_vertices.h"

namespace prefilter {

/// Moves sampled vertices that are off their lines along the surface: to where none of their
/// triangles is upside down, or to between their neighbors. If that fails, moves them to their
/// lines, which may be off the surface.
class OffLineVertices {
 public:
  /// Keeps references to all arguments; `turned` is the result of turned_labels.
  OffLineVertices(const FeatureSurface& surface, const VertexSamples& samples,
                  const std::unordered_set<std::int32_t>& turned)
      : surface_(surface), samples_(samples), turned_(turned), moves_(samples.samples.size(), 0) {}

  /// Collects such vertices of a triangle; returns whether there are any.
  bool take(const std::array<std::int32_t, 3>& triangle, std::span<const Vector3> positions);

  /// Moves the collected vertices, and flags them. `triangles` must include all triangles around
  /// them.
  void move(std::span<const std::array<std::int32_t, 3>> triangles,
            std::vector<std::uint8_t>* is_moved, std::vector<Vector3>* positions);

 private:
  // Neighborhood of a collected vertex.
  struct Around {
    Vector3 mean{};    // of the vertices around it
    Vector3 across{};  // direction over the far side of a triangle that is upside down
  };

  Vector3 next_place(const Vector3& from, const Around& around, std::int32_t index);
  std::vector<Around> look_around(std::span<const std::array<std::int32_t, 3>> triangles,
                                  std::span<const Vector3> positions) const;
  Vector3 way_across(std::int32_t vertex, const Vector3& from, const Vector3& a,
                     const Vector3& b) const;

  const FeatureSurface& surface_;
  const VertexSamples& samples_;
  const std::unordered_set<std::int32_t>& turned_;
  std::vector<std::uint8_t> moves_;
  std::vector<std::int32_t> taken_;
};

}  // namespace prefilter
