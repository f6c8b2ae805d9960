// SPDX-License-Identifier: GPL-3.0-or-later

// Joins the slabs' parts of a mesh as they arrive.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "prefilter/points/mesh_sink.h"
#include "prefilter/points/reconstruct/cut_builder.h"
#include "prefilter/points/reconstruct/sample_grid.h"
#include "prefilter/voxels/contour/contour_slab.h"

namespace prefilter {

/// One slab's part of the mesh, ready to be joined.
struct SlabMesh {
  ContourSlab contour;                   // positions in cells
  std::vector<float> attributes;         // of each vertex
  std::vector<std::uint8_t> is_trimmed;  // vertices too far from all samples; empty: none
  std::vector<FarMidpoint<std::int32_t>> far_midpoints;  // indices into the contour
};

/// Assigns vertex numbers in order of first use by a triangle, and forwards the mesh. Slabs arrive
/// from bottom to top.
class MeshJoiner {
 public:
  MeshJoiner(const SampleGrid& grid, std::size_t attribute_count, MeshSink* sink)
      : grid_(grid), attribute_count_(attribute_count), sink_(sink) {}

  /// `top` is the height at which the next slab begins.
  void add(const SlabMesh& slab, int top);
  /// Far midpoints of the last slab, in terms of vertex numbers. Requires that none of its
  /// triangles was trimmed.
  const std::vector<FarMidpoint<std::int64_t>>& far_midpoints() const { return far_midpoints_; }
  /// Numbers of the vertices that later slabs may refer to.
  std::vector<std::int64_t> shared() const;

  std::size_t vertices() const { return vertices_; }
  std::size_t triangles() const { return triangles_; }

 private:
  struct Known {
    std::int64_t number;
    int high;  // greatest height of the cells around the vertex
  };

  SampleGrid grid_;
  std::size_t attribute_count_;
  MeshSink* sink_;
  std::size_t vertices_ = 0;
  std::size_t triangles_ = 0;
  std::vector<FarMidpoint<std::int64_t>> far_midpoints_;
  std::unordered_map<std::uint64_t, Known> known_;  // vertices that later slabs may refer to
};

}  // namespace prefilter
