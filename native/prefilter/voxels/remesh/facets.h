// SPDX-License-Identifier: GPL-3.0-or-later

// Triangles with their simplification history, between two passes over patches.
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

/// Triangles with the data that Patch stores about them; empty arrays mean 0 everywhere. Points are
/// in the mesh's coordinates.
struct Facets {
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::int32_t> labels;
  std::vector<std::uint8_t> creases;
  std::vector<float> errors;
  std::vector<float> deviations;
  std::vector<std::array<float, 3>> crease_errors;
  std::vector<std::uint32_t> point_ends;  // end of each triangle's points
  std::vector<Vector3> points;
};

/// Converts between the coordinates of a mesh and of a patch.
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

/// The mesh vertices of a patch, beginning with the shared ones, sorted.
struct PatchVertices {
  std::vector<std::int32_t> all;
  std::size_t shared = 0;
};

/// Numbers the vertices of a patch. `vertex_indices` has one entry per vertex of the mesh; those
/// that the patch owns receive their number.
PatchVertices number_vertices(const PatchDivision& division, std::size_t patch,
                              std::span<const std::array<std::int32_t, 3>> triangles,
                              std::vector<std::int32_t>* vertex_indices);

/// Copies the triangles of a patch, with their history and points.
void take_triangles(const Facets& facets, const PatchDivision& division, std::size_t patch,
                    const PatchVertices& vertices, const std::vector<std::int32_t>& vertex_indices,
                    const PatchFrame& frame, Patch* result);

/// Marks as creases all sides whose other triangle is in the patch too, and fixes corners at which
/// the number of creases is not two. `kinds` are those of the mesh, or empty.
void find_creases(std::span<const VertexKind> kinds, std::span<const std::int32_t> vertices,
                  Patch* patch);

/// The remaining triangles of a patch.
Facets facets_of(const Patch& patch, std::span<const std::int32_t> vertices,
                 const PatchFrame& frame, bool has_labels, bool has_creases);

/// Moves facets to the end of `all`.
void append(Facets* facets, Facets* all);

}  // namespace prefilter
