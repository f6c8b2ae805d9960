// SPDX-License-Identifier: GPL-3.0-or-later

// Joins the parts of all slabs, and trims and simplifies the mesh as the options request.
#pragma once

#include <cstddef>
#include <optional>

#include "prefilter/base/run.h"
#include "prefilter/points/mesh_sink.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/mesh_joiner.h"
#include "prefilter/points/reconstruct/sample_grid.h"
#include "prefilter/points/reconstruct/surface_cutter.h"
#include "prefilter/points/reconstruct/surface_simplifier.h"

namespace prefilter {

/// Number of attributes per vertex of a part: those of the points, plus the support attributes
/// where the caller wants them or the surface is trimmed by them.
std::size_t part_width(std::size_t attribute_count, const ReconstructOptions& options);

class PartJoiner {
 public:
  /// `options.memory_limit` applies to the parts of the mesh that must be stored;
  /// `options.progress` is only used for canceling.
  PartJoiner(const SampleGrid& grid, int slab_height, std::size_t attribute_count,
             const ReconstructOptions& options, MeshSink* sink);

  /// Adds the next slab's part, from bottom to top.
  void add(const SlabMesh& part);
  /// Outputs the remaining mesh, and writes its size and trimming to the report.
  void finish(const Run& run, ReconstructReport* report);

 private:
  SampleGrid grid_;
  int slab_height_;
  int next_ = 0;
  MeshSink* sink_;
  std::optional<SurfaceSimplifier> simplifier_;
  std::optional<SurfaceCutter> cutter_;
  std::optional<MeshJoiner> joiner_;
};

}  // namespace prefilter
