// SPDX-License-Identifier: GPL-3.0-or-later

// The surface of samples in cells, slab by slab.
#pragma once

#include <cstddef>
#include <functional>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
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

/// Slabs are up to 64 cells high; lower where there are many cells, so that those in memory at a
/// time are fewer. That follows from the depth alone, as the order of triangles follows from it.
int slab_bits(int depth);

class SurfaceParts {
 public:
  /// Finds what all slabs have in common. The source is read again for the D4 basis, and else may
  /// be null. Throws Error for normals that contradict each other everywhere; Error(kCancelled).
  SurfaceParts(PointSource* source, std::size_t attribute_count, const SampleGrid& grid,
               const CloudExtent& extent, const ReconstructOptions& options, bool keeps_all,
               SampleStore* store);

  int count() const { return slabs_.count(); }
  int slab_height() const { return slabs_.height(); }
  /// Makes the parts of slabs from `begin` up to `end`, some at a time, and hands them on in order.
  void make(int begin, int end, const Progress& progress,
            const std::function<void(const SlabMesh&)>& use);

  /// Sets what was found of all of them.
  void describe(ReconstructReport* report) const;

 private:
  ReconstructOptions options_;
  Slabs slabs_;
  SurfaceLevel level_;
  SampleNoise noise_;
  std::size_t attribute_count_;
  double cell_;
  double outliers_ = 0.0;  // the share of the weight
  bool is_flipped_ = false;
};

}  // namespace prefilter
