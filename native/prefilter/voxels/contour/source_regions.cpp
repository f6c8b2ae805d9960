// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/source_regions.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/voxels/contour/region_borders.h"
#include "prefilter/voxels/contour/region_corners.h"
#include "prefilter/voxels/contour/smooth_regions.h"

namespace prefilter {
namespace {

constexpr double kLeastRegion = 4.0;  // in areas of a cell's face
constexpr double kWideCells = 1.5;  // minimum width of facets that make adjacent blunt edges count
// width of regions up to which blunt edges on both sides do not count
constexpr double kNarrowCells = 1.0;
constexpr double kLargest = 1e150;

std::vector<std::uint8_t> ends_of(const std::vector<Wall>& walls, std::size_t vertices) {
  std::vector<std::uint8_t> is_end(vertices, 0);
  for (const Wall& wall : walls) {
    for (const std::int32_t end : wall.ends) is_end[static_cast<std::size_t>(end)] = 1;
  }
  return is_end;
}
}  // namespace

JoinedMeshes::JoinedMeshes(std::span<const SourceMesh> sources) {
  for (const SourceMesh& source : sources) {
    check_mesh(source.mesh, kLargest);
    if (!source.groups.empty() && source.groups.size() != source.mesh.triangles.size()) {
      throw_invalid("sources: " + std::to_string(source.groups.size()) + " groups of " +
                    std::to_string(source.mesh.triangles.size()) +
                    " triangles; one each is needed");
    }
    meshes_.push_back(source.mesh);
    groups_.push_back(source.groups);
    first_vertices_.push_back(first_vertices_.back() + source.mesh.positions.size());
    first_triangles_.push_back(first_triangles_.back() + source.mesh.triangles.size());
  }
  constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max() / 3;
  if (vertex_count() > kMost || triangle_count() > kMost) {
    throw_invalid("sources: " + std::to_string(std::max(vertex_count(), triangle_count())) +
                  " vertices or triangles; at most " + std::to_string(kMost) + " are allowed");
  }
}

Vector3 direction_of(const FramedPositions& positions, std::int32_t from, std::int32_t to) {
  const Vector3 d =
      positions[static_cast<std::size_t>(to)] - positions[static_cast<std::size_t>(from)];
  const double size = length(d);
  return size > 0.0 ? (1.0 / size) * d : d;
}

SourceRegions find_regions(std::span<const SourceMesh> sources, const RootFrame& frame, double cell,
                           const Run& run) {
  const double least = kLeastRegion * cell * cell;
  WeldedMeshes welded(sources, frame);
  SmoothRegions regions = join_smooth(kWideCells * cell, run.part(0.0, 0.7), &welded);
  const RegionAreas areas =
      measure_regions(welded, regions.region_count, run.part(0.7, 0.85), &regions.labels);
  join_small(welded, areas.regions, least, kNarrowCells * cell, &regions);
  run.report(0.9);
  const std::vector<std::uint8_t> is_on_wall = ends_of(regions.walls, welded.positions.size());
  std::vector<RegionBorder> borders = find_borders(welded, cell, &regions);
  std::vector<RegionCorner> corners = border_corners(welded.positions, borders);
  for (RegionCorner& tip : tips(welded, regions.labels, is_on_wall, areas.vertices, least)) {
    corners.push_back(std::move(tip));
  }
  run.report(1.0);
  return {welded.positions,          JoinedTriangles(welded.meshes),
          std::move(regions.labels), std::move(regions.parts),
          std::move(borders),        std::move(corners),
          regions.part_count};
}

}  // namespace prefilter
