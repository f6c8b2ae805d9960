// SPDX-License-Identifier: GPL-3.0-or-later

// Joins triangles of meshes across smooth edges.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/source_regions.h"

namespace prefilter {

/// Several meshes as one, with vertices at equal positions welded if necessary.
struct WeldedMeshes {
  JoinedMeshes meshes;
  FramedPositions positions;
  std::vector<std::int32_t> firsts;  // per vertex: the first at its position; empty: no welding

  WeldedMeshes(std::span<const SourceMesh> sources, const RootFrame& frame)
      : meshes(sources), positions(meshes, frame) {}

  std::size_t triangle_count() const { return meshes.triangle_count(); }
  std::array<std::int32_t, 3> triangle(std::size_t t) const {
    std::array<std::int32_t, 3> triangle = meshes.triangle(t);
    if (!firsts.empty()) {
      for (std::int32_t& vertex : triangle) vertex = firsts[static_cast<std::size_t>(vertex)];
    }
    return triangle;
  }
  Vector3 position(std::int32_t vertex) const {
    return positions[static_cast<std::size_t>(vertex)];
  }
  /// Area vector times 2.
  Vector3 normal(std::size_t t) const {
    const auto [i, j, k] = meshes.triangle(t);
    const Vector3 a = position(i);
    return cross(position(j) - a, position(k) - a);
  }
};

/// An edge of exactly two triangles that do not belong to one smooth surface.
struct Wall {
  std::array<std::int32_t, 2> ends;  // the lower vertex first
  std::array<std::int32_t, 2> triangles;
  bool is_crease = false;  // turns by less than 20 degrees, beside a wide facet
};

struct SmoothRegions {
  std::vector<std::int32_t> labels;  // per triangle: its region
  int region_count = 0;
  std::vector<std::int32_t> parts;  // per triangle: its component, connected by edges
  int part_count = 0;
  std::vector<Wall> walls;
};

/// For each vertex the first one at its position. Throws Error(kCancelled).
std::vector<std::int32_t> first_places(const FramedPositions& positions, const Run& run);

/// Joins triangles of one group at edges that turn by less than 20 degrees. Facets wider than
/// `least_width` are only joined at edges of less than 1 degree, or with a smaller deviation than
/// an edge of 7.6 degrees and this width. If some edges have a single side, `welded` gets first
/// places before that. Throws Error(kCancelled).
SmoothRegions join_smooth(double least_width, const Run& run, WeldedMeshes* welded);

}  // namespace prefilter
