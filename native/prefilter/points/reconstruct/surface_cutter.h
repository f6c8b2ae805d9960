// SPDX-License-Identifier: GPL-3.0-or-later

// Trims a mesh that arrives part by part where no samples support it.
//
// The regions to cut, and the islands, are only known after the last part. Until then the mesh is
// stored in memory or in a file; regions are represented by totals over their pieces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/points/mesh_sink.h"
#include "prefilter/points/reconstruct/cut_builder.h"
#include "prefilter/points/reconstruct/cut_parts.h"
#include "prefilter/points/reconstruct/mesh_counts.h"
#include "prefilter/points/reconstruct/surface_regions.h"
#include "prefilter/points/trim_surface.h"

namespace prefilter {

class SurfaceCutter final : public MeshSink {
 public:
  /// `width` is the number of attributes per vertex, of which the last two are the support
  /// attributes; these are removed from the result unless `keeps_support`. `cell` is the smallest
  /// spacing of samples.
  SurfaceCutter(const TrimOptions& options, std::size_t width, double cell, bool keeps_support,
                std::uint64_t memory_limit, std::string folder);

  void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) override {
    builder_.add_vertices(std::move(positions), std::move(attributes));
  }
  void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) override {
    builder_.add_triangles(std::move(triangles));
  }
  /// Sets the far midpoints of the current part; edges are given by the numbers of their ends.
  void add_far_midpoints(const std::vector<FarMidpoint<std::int64_t>>& places) {
    builder_.add_far_midpoints(places);
  }
  /// Requests that the regions around these vertices of the part be cut, provided that they are
  /// far.
  void request_cut(std::vector<std::int64_t> numbers) { builder_.request_cut(std::move(numbers)); }
  /// Later parts may refer to the vertices in `shared`, but to no others.
  void end_part(std::span<const std::int64_t> shared) override {
    parts_.add(builder_.take_part(shared));
  }

  /// Outputs the remaining mesh in parts.
  TrimReport finish(const Run& run, MeshSink* sink);

  const MeshCounts& counts() const { return counts_; }
  bool is_spilled() const { return parts_.is_spilled(); }

 private:
  TrimOptions options_;
  std::size_t width_;
  bool keeps_support_;
  SurfaceRegions regions_;
  CutBuilder builder_;
  CutParts parts_;
  MeshCounts counts_;
};

}  // namespace prefilter
