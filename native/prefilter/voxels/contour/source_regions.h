// SPDX-License-Identifier: GPL-3.0-or-later

// The smooth regions of meshes, and the edges between them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/contour/root_frame.h"
#include "prefilter/voxels/contour_options.h"

namespace prefilter {

/// Edges that turn by less are smooth: 20 degrees.
inline constexpr double kSharpCosine = 0.9396926207859084;

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

/// The vertices and triangles of several meshes, numbered through, as their owners hold them.
class JoinedMeshes {
 public:
  JoinedMeshes() = default;
  /// Throws Error as check_mesh does, and for too many.
  explicit JoinedMeshes(std::span<const SourceMesh> sources);

  std::size_t vertex_count() const { return first_vertices_.back(); }
  std::size_t triangle_count() const { return first_triangles_.back(); }
  /// Where a vertex is, in its mesh's space.
  Vector3 position(std::size_t vertex) const {
    const std::size_t i = mesh_of(first_vertices_, vertex);
    return meshes_[i].positions[vertex - first_vertices_[i]];
  }
  std::array<std::int32_t, 3> triangle(std::size_t triangle) const {
    const std::size_t i = mesh_of(first_triangles_, triangle);
    const auto [a, b, c] = meshes_[i].triangles[triangle - first_triangles_[i]];
    const auto first = static_cast<std::int32_t>(first_vertices_[i]);
    return {static_cast<std::int32_t>(a) + first, static_cast<std::int32_t>(b) + first,
            static_cast<std::int32_t>(c) + first};
  }
  /// 0 where the mesh has no groups.
  std::int32_t group(std::size_t triangle) const {
    const std::size_t i = mesh_of(first_triangles_, triangle);
    return groups_[i].empty() ? 0 : groups_[i][triangle - first_triangles_[i]];
  }

 private:
  static std::size_t mesh_of(const std::vector<std::size_t>& firsts, std::size_t index) {
    std::size_t i = 0;
    while (index >= firsts[i + 1]) ++i;
    return i;
  }

  std::vector<InputMesh> meshes_;
  std::vector<std::span<const std::int32_t>> groups_;
  std::vector<std::size_t> first_vertices_ = {0};
  std::vector<std::size_t> first_triangles_ = {0};
};

/// Vertices in a frame, carried there as they are read.
class FramedPositions {
 public:
  FramedPositions(const JoinedMeshes& meshes, const RootFrame& frame)
      : meshes_(meshes), frame_(frame) {}
  std::size_t size() const { return meshes_.vertex_count(); }
  Vector3 operator[](std::size_t vertex) const {
    return frame_.from_space(meshes_.position(vertex));
  }

 private:
  JoinedMeshes meshes_;
  RootFrame frame_;
};

/// From a vertex to another one, of length 1; 0 where they are at one place.
Vector3 direction_of(const FramedPositions& positions, std::int32_t from, std::int32_t to);

class JoinedTriangles {
 public:
  explicit JoinedTriangles(const JoinedMeshes& meshes) : meshes_(meshes) {}
  std::size_t size() const { return meshes_.triangle_count(); }
  std::array<std::int32_t, 3> operator[](std::size_t triangle) const {
    return meshes_.triangle(triangle);
  }

 private:
  JoinedMeshes meshes_;
};

/// Meshes as one, cut into regions along edges of more than 20 degrees, and between groups. Holds
/// no copy of the meshes, which have to live as long.
struct SourceRegions {
  FramedPositions positions;
  JoinedTriangles triangles;
  std::vector<std::int32_t> labels;  // of each triangle, its region; -1 without an area
  std::vector<std::int32_t> parts;   // of each triangle, what hangs together by its edges
  std::vector<RegionBorder> borders;
  std::vector<RegionCorner> corners;
  int part_count = 0;

  Vector3 corner(std::size_t triangle, int i) const {
    return positions[static_cast<std::size_t>(triangles[triangle][static_cast<std::size_t>(i)])];
  }
  std::array<Vector3, 3> corners_of(std::size_t triangle) const {
    return {corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)};
  }
};

/// Vertices at one place count as one. Regions of less than four faces of a cell join the
/// neighbor with which they share the longest border, and edges within a region count only where
/// those that hang together are eight cells long: what is smaller is roughness. `cell` is the side
/// of a cell.
///
/// Throws Error as check_mesh does, and for groups that are not as many as the triangles;
/// Error(kCancelled).
SourceRegions find_regions(std::span<const SourceMesh> sources, const RootFrame& frame, double cell,
                           const Progress& progress, int threads);

}  // namespace prefilter
