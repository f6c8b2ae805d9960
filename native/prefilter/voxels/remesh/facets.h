// SPDX-License-Identifier: GPL-3.0-or-later

// Triangles between two times that vertices of patches are removed.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"
#include "prefilter/voxels/remesh/patch.h"
#include "prefilter/voxels/remesh/patch_division.h"

namespace prefilter {

/// Triangles with what Patch knows of them; what is empty is 0 everywhere. Points are the mesh's.
struct Facets {
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::int32_t> labels;
  std::vector<std::uint8_t> creases;
  std::vector<float> errors;
  std::vector<float> deviations;
  std::vector<std::array<float, 3>> crease_errors;
  std::vector<std::uint32_t> point_ends;  // of each triangle's points
  std::vector<Vector3> points;
};

/// From a mesh's lengths to a patch's, and back.
struct PatchFrame {
  Vector3 origin;
  double tolerance;

  Vector3 local(const Vector3& p) const {
    const Vector3 d = p - origin;
    return {d[0] / tolerance, d[1] / tolerance, d[2] / tolerance};
  }
  Vector3 global(const Vector3& p) const {
    return origin + Vector3{p[0] * tolerance, p[1] * tolerance, p[2] * tolerance};
  }
};

/// The mesh's vertices of a patch, those that it shares first, in order.
struct PatchVertices {
  std::vector<std::int32_t> all;
  std::size_t shared = 0;
};

/// `places` has one for each vertex of the mesh: those that are the patch's own get their number.
PatchVertices number_vertices(const PatchDivision& division, std::size_t patch,
                              std::span<const std::array<std::int32_t, 3>> triangles,
                              std::vector<std::int32_t>* places);

/// The triangles of a patch, with what is known of them, and its points.
void take_triangles(const Facets& facets, const PatchDivision& division, std::size_t patch,
                    const PatchVertices& vertices, const std::vector<std::int32_t>& places,
                    const PatchFrame& frame, Patch* made);

/// Sets the creases of sides whose other triangle is in the patch, and keeps the corners where not
/// just two creases meet. `kinds` are those of the mesh, or none.
void find_creases(std::span<const VertexKind> kinds, std::span<const std::int32_t> vertices,
                  Patch* patch);

/// What is left of a patch.
Facets facets_of(const Patch& patch, std::span<const std::int32_t> vertices,
                 const PatchFrame& frame, bool has_labels, bool has_creases);

/// Adds facets, and leaves none.
void append(Facets* some, Facets* all);

}  // namespace prefilter
