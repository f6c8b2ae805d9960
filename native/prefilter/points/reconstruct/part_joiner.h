// SPDX-License-Identifier: GPL-3.0-or-later

// The parts of slabs to a mesh, cut and simplified as options say.
#pragma once

#include <cstddef>
#include <optional>

#include "prefilter/base/progress.h"
#include "prefilter/points/mesh_sink.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/mesh_joiner.h"
#include "prefilter/points/reconstruct/sample_grid.h"
#include "prefilter/points/reconstruct/surface_cutter.h"
#include "prefilter/points/reconstruct/surface_simplifier.h"

namespace prefilter {

/// How many attributes vertices of slabs have: those of points, and what tells how well points
/// support them, where that is wanted or the surface is cut by it.
std::size_t part_width(std::size_t attribute_count, const ReconstructOptions& options);

class PartJoiner {
 public:
  /// The memory limit of the options is that of the mesh, as far as that has to be kept; their
  /// progress is for cancels alone.
  PartJoiner(const SampleGrid& grid, int slab_height, std::size_t attribute_count,
             const ReconstructOptions& options, MeshSink* sink);

  /// Slab by slab, from below.
  void add(const SlabMesh& part);
  /// Hands on what is left, and says what the mesh is like.
  void finish(const Progress& progress, ReconstructReport* report);

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
