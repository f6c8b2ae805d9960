// SPDX-License-Identifier: GPL-3.0-or-later

// A mesh that comes part by part, with fewer triangles where it is flat or gently curved.
//
// Each part is simplified with what is left around its lower end, and what is around its upper end
// waits for the next one, with what is known of the surface that was there: so the tolerance holds
// across parts, and no row of small triangles stays between them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/points/mesh_sink.h"
#include "prefilter/points/reconstruct/mesh_counts.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"
#include "prefilter/voxels/remesh/facets.h"

namespace prefilter {

struct SimplifierOptions {
  double tolerance;   // above 0: how far from the surface that came, as `simplify` has it
  std::size_t width;  // of attributes, for each vertex
  bool has_support;   // the last two are those of support_attributes()
  int threads;
  Progress progress;  // for cancels alone
};

/// Hands a mesh on to a sink with fewer vertices, which neither move nor change their attributes.
/// Vertices stay where the mesh ends, where it is no two-manifold, and where it is farther from all
/// samples than TrimOptions have it, so that it can be cut there. A two-manifold stays one, with
/// the same ends.
class SurfaceSimplifier final : public MeshSink {
 public:
  SurfaceSimplifier(SimplifierOptions options, MeshSink* sink);

  void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) override;
  void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) override;
  /// Throws Error(kCancelled).
  void end_part(std::span<const std::int64_t> shared) override;

  const MeshCounts& counts() const { return counts_; }

 private:
  // What has come and was not handed on.
  struct Pending {
    FacetedMesh mesh;  // positions alone
    Facets facets;
    std::vector<float> attributes;
    std::vector<std::int64_t> numbers;                      // of vertices, as they came
    std::vector<std::int64_t> out_numbers;                  // as they are handed on; -1: not yet
    std::unordered_map<std::int64_t, std::int32_t> places;  // of vertices by their numbers
  };

  std::span<const float> attributes_of(std::size_t vertex) const;
  std::vector<std::uint8_t> far_vertices() const;
  void hand_on(const std::vector<std::uint8_t>& is_waiting);
  void keep(const std::vector<std::uint8_t>& is_waiting, std::span<const std::int64_t> shared);

  SimplifierOptions options_;
  MeshSink* sink_;
  MeshCounts counts_;
  std::int64_t next_number_ = 0;
  Pending pending_;
  std::vector<std::array<std::int32_t, 3>> added_;  // triangles of the part
};

}  // namespace prefilter
