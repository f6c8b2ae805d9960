// SPDX-License-Identifier: GPL-3.0-or-later

// Makes a slab's part of the surface: contours it, fits it to the samples, and trims it.
#pragma once

#include <cstddef>

#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/fit_samples.h"
#include "prefilter/points/reconstruct/mesh_joiner.h"
#include "prefilter/points/reconstruct/sample_index.h"
#include "prefilter/points/reconstruct/slabs.h"
#include "prefilter/points/reconstruct/surface_level.h"

namespace prefilter {

/// Data shared by all parts of a surface.
struct SurfaceSamples {
  const Slabs& slabs;
  std::size_t attribute_count = 0;
  SampleNoise noise;
  double cell = 1.0;  // side of a finest cell, in the points' units
};

/// Index of the samples of depth `k` in slab `s` and up to `margin` cells of that depth around it,
/// limited to the adjacent slabs.
SampleIndex samples_around(const Slabs& slabs, int s, int k, int margin);

/// Measures the noise of the samples on some cells of a slab. Advances the slabs around it to
/// kLeaves.
SampleNoise find_noise(int s, Slabs* slabs);

/// The part in slab `s`. The values of the slab and its neighbors must have been computed.
SlabMesh mesh_of_slab(const SurfaceSamples& surface, const ReconstructOptions& options,
                      const SurfaceLevel& level, int s);

/// Marks the vertices of slab `s` that are farther than `limit` finest cells from all samples.
/// Distances are measured to the mean samples of cells, which are small against the limit.
void mark_far_vertices(const Slabs& slabs, int s, double limit, SlabMesh* slab);

}  // namespace prefilter
