// SPDX-License-Identifier: GPL-3.0-or-later

// Positions the vertices of quads: one for each loop of a contour.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/dual_loops.h"
#include "prefilter/voxels/contour/edge_source.h"
#include "prefilter/voxels/contour/feature_places.h"

namespace prefilter {

/// A vertex on the edge between two regions, and the adjacent vertices along the edge.
struct EdgeVertex {
  std::vector<std::int32_t> labels;
  std::array<std::int32_t, 2> beside;
};

/// Target positions of a quad mesh's vertices, with fallbacks that never fold.
struct DualPlaces {
  std::vector<Vector3> positions;       // target
  std::vector<std::uint8_t> is_sharp;   // per vertex: on an edge or a corner of the shape
  std::vector<std::uint8_t> is_corner;  // per vertex: on a corner of the shape
  std::vector<std::int32_t> on_edge;    // per vertex: its EdgeVertex; -1: none
  std::vector<EdgeVertex> edge_vertices;
  // Centers of the loops, for the vertices' positions and for vertices halfway between cells.
  std::vector<Vector3> middles;
  std::vector<Vector3> safe;
  std::vector<Vector3> cells;  // centers of their dual cells
};

/// Positions of smooth vertices are on the surface through the loop's vertices: their mean, plus
/// half of the mean height of the tangent planes above it, which is exact for quadrics. Other
/// vertices are on the edges and corners of the surface from which the vertices were sampled, found
/// by `features`, if not null. `halfway` holds the positions of vertices halfway between cells.
/// Throws Error(kCancelled).
DualPlaces dual_places(const DualLoops& loops, const std::vector<Vector3>& positions,
                       const std::vector<Vector3>& halfway, const EdgeSource& edges,
                       const FeaturePlaces* features, const Vector3& cell, const Run& run);

}  // namespace prefilter
