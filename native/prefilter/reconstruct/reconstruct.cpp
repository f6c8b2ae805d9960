// SPDX-License-Identifier: GPL-3.0-or-later

// Slab by slab (section 4.3.2): the samples of all slabs give the coarse levels of the tree; with
// these a slab's own levels can be made, smoothed, contoured and dropped.
#include "prefilter/reconstruct/reconstruct.h"

#include <vector>

#include "prefilter/reconstruct/cloud_grid.h"
#include "prefilter/reconstruct/gather_samples.h"
#include "prefilter/reconstruct/memory_plan.h"
#include "prefilter/reconstruct/part_joiner.h"
#include "prefilter/reconstruct/reconstruct_checks.h"
#include "prefilter/reconstruct/sample_store.h"
#include "prefilter/reconstruct/stray_points.h"
#include "prefilter/reconstruct/surface_parts.h"

namespace prefilter {
std::vector<PointAttribute> support_attributes() {
  return {{"distance", false}, {"density", false}};
}

ReconstructReport reconstruct(PointSource* source, const ReconstructOptions& options,
                              MeshSink* sink) {
  check_options(options);
  ThinnedPoints some;
  const bool is_automatic = !options.depth && !options.cell_size;
  CloudLoad load = {source->count().value_or(PointOrder::kMostPoints), source->attributes().size(),
                    options.basis, options.adaptivity > 0.0};
  const int width = batches_at_once(load, options);
  CloudExtent extent = measure_cloud(source, options.progress.part(0.0, 0.08), width,
                                     is_automatic ? &some : nullptr);
  check_cloud(extent);
  load.points = extent.part.points;
  leave_out_strays(source, options.progress.part(0.08, 0.1), width, &extent);
  PointsWithin near(source, extent.part.box);
  if (extent.strays > 0) source = &near;
  ReconstructReport report;
  const SampleGrid grid = grid_of(extent.part.box, some, options);
  some = ThinnedPoints();
  describe_grid(grid, extent, &report);
  SampleStore store(grid.depth, slab_bits(grid.depth), source->attributes().size(),
                    options.memory_limit / 4, options.folder);
  gather_samples(source, grid, options.progress.part(0.12, 0.4), width, &store);
  const MemoryPlan plan = plan_memory(store, load, options);
  if (!plan.is_held) store.spill();
  report.is_spilled = store.is_spilled();
  ReconstructOptions rest = options;
  rest.progress = options.progress.part(0.4, 1.0);
  rest.threads = plan.threads;
  rest.memory_limit = plan.left;
  SurfaceParts parts(source, load.attributes, grid, extent, rest, plan.keeps_all, &store);
  parts.describe(&report);
  ReconstructOptions mesh = rest;
  mesh.progress = rest.progress.part(0.6, 0.6);
  PartJoiner joiner(grid, parts.slab_height(), load.attributes, mesh, sink);
  parts.make(0, parts.count(), rest.progress.part(0.6, 0.95),
             [&](const SlabMesh& part) { joiner.add(part); });
  joiner.finish(rest.progress.part(0.95, 1.0), &report);
  check_mesh(options, report);
  return report;
}

}  // namespace prefilter
