// SPDX-License-Identifier: GPL-3.0-or-later

// Where the vertices of quads are: one for each loop of a contour.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/voxels/contour/dual_loops.h"
#include "prefilter/voxels/contour/edge_source.h"
#include "prefilter/voxels/contour/feature_places.h"

namespace prefilter {

/// A vertex on the edge between two regions, and those next to it along the edge.
struct EdgeVertex {
  std::vector<std::int32_t> labels;
  std::array<std::int32_t, 2> beside;
};

/// What a quad mesh's vertices may go back to, as far as they have to.
struct DualPlaces {
  std::vector<Vector3> positions;       // where they should be
  std::vector<std::uint8_t> is_sharp;   // of each: on an edge or a corner of the shape
  std::vector<std::uint8_t> is_corner;  // of each: on a corner of the shape
  std::vector<std::int32_t> on_edge;    // of each: its EdgeVertex; -1: none
  std::vector<EdgeVertex> edge_vertices;
  // In the middle of their loops: as these are, and of vertices halfway between cells.
  std::vector<Vector3> middles;
  std::vector<Vector3> safe;
  std::vector<Vector3> cells;  // the middles of their dual cells
};

/// Smooth ones are where the surface through the loop's vertices is: the mean of these, and half of
/// what their tangent planes are above it, which is exact for quadrics. Others are on the edges and
/// corners of what the vertices were sampled from, which `features` are of, if there are any.
/// `halfway` are the positions of vertices halfway between cells. Throws Error(kCancelled).
DualPlaces dual_places(const DualLoops& loops, const std::vector<Vector3>& positions,
                       const std::vector<Vector3>& halfway, const EdgeSource& edges,
                       const FeaturePlaces* features, const Vector3& cell, const Progress& progress,
                       int threads);

}  // namespace prefilter
