// The smooth regions of meshes, and the edges between them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/contour/contour_options.h"
#include "prefilter/contour/root_frame.h"

namespace prefilter {

/// An edge of a mesh between two regions, or a sharp one within a region.
struct RegionBorder {
  std::array<std::int32_t, 2> ends;
  std::array<std::int32_t, 2> labels;
  std::array<std::int32_t, 2> triangles;
};

/// A vertex where borders meet, end or turn, or where a smooth region comes to a point.
struct RegionCorner {
  std::int32_t vertex;
  std::vector<std::int32_t> labels;  // of the regions around it, in order
};

/// Meshes as one, cut into regions along edges of more than 20 degrees, and between groups.
struct SourceRegions {
  std::vector<Vector3> positions;  // the frame's
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::int32_t> labels;  // of each triangle, its region; -1 without an area
  std::vector<std::int32_t> parts;   // of each triangle, what hangs together by its edges
  std::vector<RegionBorder> borders;
  std::vector<RegionCorner> corners;
  int part_count = 0;

  Vector3 corner(std::size_t triangle, int i) const {
    return positions[static_cast<std::size_t>(triangles[triangle][static_cast<std::size_t>(i)])];
  }
};

/// Vertices at one place count as one. Regions of less than half of a cell's face join the
/// neighbour with which they share the longest border, and edges within a region count only where
/// those that hang together are three cells long: what is smaller is roughness. `cell` is the side
/// of a cell.
///
/// Throws Error as check_mesh does, and for groups that are not as many as the triangles;
/// Error(kCancelled).
SourceRegions find_regions(std::span<const SourceMesh> sources, const RootFrame& frame, double cell,
                           const Progress& progress, int threads);

}  // namespace prefilter
