// SPDX-License-Identifier: GPL-3.0-or-later

// Reconstructs the surface of samples in cells, slab by slab.
#pragma once

#include <cstddef>
#include <functional>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/gather_samples.h"
#include "prefilter/points/reconstruct/mesh_joiner.h"
#include "prefilter/points/reconstruct/sample_grid.h"
#include "prefilter/points/reconstruct/sample_store.h"
#include "prefilter/points/reconstruct/slab_mesh.h"
#include "prefilter/points/reconstruct/slabs.h"
#include "prefilter/points/reconstruct/surface_level.h"

namespace prefilter {

/// Slabs are up to 64 cells high, but lower at large depths, to limit the number of cells in
/// memory. The height depends on the depth alone because the order of the triangles follows from
/// it.
int slab_bits(int depth);

class SurfaceParts {
 public:
  /// Computes the data that all slabs share. The source is only read for the D4 basis, and may
  /// otherwise be null. Throws Error for normals that contradict each other everywhere;
  /// Error(kCancelled).
  SurfaceParts(PointSource* source, std::size_t attribute_count, const SampleGrid& grid,
               const CloudExtent& extent, const ReconstructOptions& options, bool keeps_all,
               SampleStore* store);

  int count() const { return slabs_.count(); }
  int slab_height() const { return slabs_.height(); }
  /// Makes the parts of slabs from `begin` up to `end`, several at a time, and passes them to `use`
  /// in order.
  void make(int begin, int end, const Run& run, const std::function<void(const SlabMesh&)>& use);

  /// Writes the findings about the samples to the report.
  void describe(ReconstructReport* report) const;

 private:
  ReconstructOptions options_;
  Slabs slabs_;
  SurfaceLevel level_;
  SampleNoise noise_;
  std::size_t attribute_count_;
  double cell_;
  double outliers_ = 0.0;  // as a share of all weight
  bool is_flipped_ = false;
};

}  // namespace prefilter
