// SPDX-License-Identifier: GPL-3.0-or-later

// Smooth regions of meshes, and the edges between them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/root_frame.h"
#include "prefilter/voxels/contour_options.h"

namespace prefilter {

/// Cosine of 20 degrees; edges that turn by less are smooth.
inline constexpr double kSharpCosine = 0.9396926207859084;

/// An edge of a mesh between two regions, or a sharp one within a region.
struct RegionBorder {
  std::array<std::int32_t, 2> ends;
  std::array<std::int32_t, 2> labels;
  std::array<std::int32_t, 2> triangles;
};

/// A vertex where borders meet, end or turn, or the tip of a smooth region.
struct RegionCorner {
  std::int32_t vertex;
  std::vector<std::int32_t> labels;  // of the regions around it, sorted
};

/// The vertices and triangles of several meshes, numbered consecutively, without copying them.
class JoinedMeshes {
 public:
  JoinedMeshes() = default;
  /// Throws Error as check_mesh does, and for too many elements.
  explicit JoinedMeshes(std::span<const SourceMesh> sources);

  std::size_t vertex_count() const { return first_vertices_.back(); }
  std::size_t triangle_count() const { return first_triangles_.back(); }
  /// Position of a vertex in its mesh's space.
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
  /// 0 if the mesh has no groups.
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

/// Vertex positions, converted to a frame when read.
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

/// Unit direction from a vertex to another one; 0 if they coincide.
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

/// Several meshes as one, divided into regions at edges of more than 20 degrees, and between
/// groups. Keeps references to the meshes.
struct SourceRegions {
  FramedPositions positions;
  JoinedTriangles triangles;
  std::vector<std::int32_t> labels;  // per triangle: its region; -1 without area
  std::vector<std::int32_t> parts;   // per triangle: its component, connected by edges
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

/// Divides meshes into regions; vertices at equal positions count as one. To ignore roughness,
/// regions smaller than four faces of a cell are joined to the neighbor with the longest common
/// border, and edges within a region only count if connected edges are at least eight cells long.
/// `cell` is the side of a cell.
///
/// Throws Error as check_mesh does, and if there is not one group per triangle; Error(kCancelled).
SourceRegions find_regions(std::span<const SourceMesh> sources, const RootFrame& frame, double cell,
                           const Run& run);

}  // namespace prefilter
