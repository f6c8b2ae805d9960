// SPDX-License-Identifier: GPL-3.0-or-later

// Simplifies a mesh that arrives part by part, where it is flat or gently curved.
//
// Triangles near a part's upper end wait for the next part and are simplified together with it,
// along with the record of the original surface there. Therefore the tolerance holds across parts,
// and no row of small triangles remains between them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/points/mesh_sink.h"
#include "prefilter/points/reconstruct/mesh_counts.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"
#include "prefilter/voxels/remesh/facets.h"

namespace prefilter {

struct SimplifierOptions {
  double tolerance;   // above 0: maximum distance from the original surface, as in `simplify`
  std::size_t width;  // number of attributes per vertex
  bool has_support;   // the last two are those of support_attributes()
  Run run;            // for canceling only
};

/// Forwards a mesh to a sink with fewer vertices, which neither move nor change their attributes.
/// Vertices stay where the mesh ends, where it is not two-manifold, and where it is farther from
/// all samples than TrimOptions::distance, so that it can be cut there. A two-manifold mesh remains
/// one, with the same boundaries.
class SurfaceSimplifier final : public MeshSink {
 public:
  SurfaceSimplifier(SimplifierOptions options, MeshSink* sink);

  void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) override;
  void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) override;
  /// Throws Error(kCancelled).
  void end_part(std::span<const std::int64_t> shared) override;

  const MeshCounts& counts() const { return counts_; }

 private:
  // Mesh that has arrived but was not output yet.
  struct Pending {
    FacetedMesh mesh;  // positions alone
    Facets facets;
    std::vector<float> attributes;
    std::vector<std::int64_t> numbers;                      // input numbers of the vertices
    std::vector<std::int64_t> out_numbers;                  // output numbers; -1: none yet
    std::unordered_map<std::int64_t, std::int32_t> places;  // vertex of each input number
  };

  std::span<const float> attributes_of(std::size_t vertex) const;
  std::vector<std::uint8_t> far_vertices() const;
  void output_finished(const std::vector<std::uint8_t>& is_waiting);
  void retain_waiting(const std::vector<std::uint8_t>& is_waiting,
                      std::span<const std::int64_t> shared);

  SimplifierOptions options_;
  MeshSink* sink_;
  MeshCounts counts_;
  std::int64_t next_number_ = 0;
  Pending pending_;
  std::vector<std::array<std::int32_t, 3>> added_;  // triangles of the part
};

}  // namespace prefilter
