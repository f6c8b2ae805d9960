// SPDX-License-Identifier: GPL-3.0-or-later

// A mesh that comes part by part, cut where no samples support it.
//
// Which regions are cut, and which parts are islands, is known when all has come. Until then the
// mesh is kept, in memory or in a file; of the regions only what their pieces have in common is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/points/mesh_sink.h"
#include "prefilter/points/reconstruct/cut_builder.h"
#include "prefilter/points/reconstruct/cut_parts.h"
#include "prefilter/points/reconstruct/mesh_counts.h"
#include "prefilter/points/reconstruct/surface_regions.h"
#include "prefilter/points/trim_surface.h"

namespace prefilter {

class SurfaceCutter final : public MeshSink {
 public:
  /// Attributes are `width` for each vertex, the last two those of its support. `cell` is the least
  /// spacing of samples. Of attributes the last two go no further where they are not `wanted`.
  SurfaceCutter(const TrimOptions& options, std::size_t width, double cell, bool wanted,
                std::uint64_t memory_limit, std::string folder);

  void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) override {
    builder_.add_vertices(std::move(positions), std::move(attributes));
  }
  void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) override {
    builder_.add_triangles(std::move(triangles));
  }
  /// Of the part that has come; edges by the numbers of their ends.
  void add_far_places(const std::vector<FarPlace<std::int64_t>>& places) {
    builder_.add_far_places(places);
  }
  /// Has the regions cut in which these vertices of the part are, if they are far.
  void cut_at(std::vector<std::int64_t> numbers) { builder_.cut_at(std::move(numbers)); }
  /// Later parts may name those vertices that are `shared`, and no others.
  void end_part(std::span<const std::int64_t> shared) override {
    parts_.add(builder_.take_part(shared));
  }

  /// Hands on what is left, in parts.
  TrimReport finish(const Progress& progress, MeshSink* sink);

  const MeshCounts& counts() const { return counts_; }
  bool is_spilled() const { return parts_.is_spilled(); }

 private:
  TrimOptions options_;
  std::size_t width_;
  bool are_wanted_;
  SurfaceRegions regions_;
  CutBuilder builder_;
  CutParts parts_;
  MeshCounts counts_;
};

}  // namespace prefilter
