// SPDX-License-Identifier: GPL-3.0-or-later

// Triangles of meshes joined across smooth edges.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/contour/source_regions.h"

namespace prefilter {

/// Meshes as one, whose vertices at one place are one where that is needed.
struct WeldedMeshes {
  JoinedMeshes meshes;
  FramedPositions positions;
  std::vector<std::int32_t> firsts;  // of each vertex, the first at its place; none: each is

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
  /// As long as twice the area.
  Vector3 normal(std::size_t t) const {
    const auto [i, j, k] = meshes.triangle(t);
    const Vector3 a = position(i);
    return cross(position(j) - a, position(k) - a);
  }
};

/// Two triangles that meet at an edge of theirs alone, and are not of one smooth surface.
struct Wall {
  std::array<std::int32_t, 2> ends;  // the lower vertex first
  std::array<std::int32_t, 2> triangles;
  bool is_crease = false;  // of less than 20 degrees, beside a wide facet
};

struct SmoothRegions {
  std::vector<std::int32_t> labels;  // of each triangle, its region
  int region_count = 0;
  std::vector<std::int32_t> parts;  // of each triangle, what hangs together by its edges
  int part_count = 0;
  std::vector<Wall> walls;
};

/// For each vertex the first one at its place. Throws Error(kCancelled).
std::vector<std::int32_t> first_places(const FramedPositions& positions, const Progress& progress,
                                       int threads);

/// Joins triangles that meet at an edge of less than 20 degrees and are of one group; but facets
/// that are wider than `least_width` only where it is less than 1 degree, or less than an edge
/// of 7.6 degrees of this width stands out. Where some edges have one side alone, `welded` gets
/// first places before that. Throws Error(kCancelled).
SmoothRegions join_smooth(double least_width, const Progress& progress, int threads,
                          WeldedMeshes* welded);

}  // namespace prefilter
