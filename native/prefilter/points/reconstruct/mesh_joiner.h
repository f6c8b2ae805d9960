// SPDX-License-Identifier: GPL-3.0-or-later

// Parts of a mesh to one, as they come.
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

/// A slab's part of the mesh, ready to be joined.
struct SlabMesh {
  ContourSlab contour;                             // positions in cells
  std::vector<float> attributes;                   // of each vertex
  std::vector<std::uint8_t> is_trimmed;            // vertices too far from all samples; empty: none
  std::vector<FarPlace<std::int32_t>> far_places;  // by vertices and triangles of the contour
};

/// Numbers vertices as triangles first name them, and hands all on. Slabs come from below.
class MeshJoiner {
 public:
  MeshJoiner(const SampleGrid& grid, std::size_t attribute_count, MeshSink* sink)
      : grid_(grid), attribute_count_(attribute_count), sink_(sink) {}

  /// `top` is the height at which the next slab begins.
  void add(const SlabMesh& slab, int top);
  /// The far places of the slab that was added last, by the numbers of vertices. None of its
  /// triangles was trimmed.
  const std::vector<FarPlace<std::int64_t>>& far_places() const { return far_places_; }
  /// The numbers of vertices that the next slabs may name.
  std::vector<std::int64_t> shared() const;

  std::size_t vertices() const { return vertices_; }
  std::size_t triangles() const { return triangles_; }

 private:
  struct Known {
    std::int64_t number;
    int high;  // that the vertex reaches
  };

  SampleGrid grid_;
  std::size_t attribute_count_;
  MeshSink* sink_;
  std::size_t vertices_ = 0;
  std::size_t triangles_ = 0;
  std::vector<FarPlace<std::int64_t>> far_places_;
  std::unordered_map<std::uint64_t, Known> known_;  // that the next slabs may name
};

}  // namespace prefilter
