// SPDX-License-Identifier: GPL-3.0-or-later

// Reconstructs slab by slab (section 4.3.2). The samples of all slabs determine the coarse levels
// of the octree; given these, each slab's own levels are computed, smoothed, contoured and dropped.
#include "prefilter/points/reconstruct.h"

#include <optional>
#include <vector>

#include "prefilter/points/reconstruct/cloud_grid.h"
#include "prefilter/points/reconstruct/gather_samples.h"
#include "prefilter/points/reconstruct/measured_cloud.h"
#include "prefilter/points/reconstruct/memory_plan.h"
#include "prefilter/points/reconstruct/normal_probe.h"
#include "prefilter/points/reconstruct/part_joiner.h"
#include "prefilter/points/reconstruct/reconstruct_checks.h"
#include "prefilter/points/reconstruct/sample_store.h"
#include "prefilter/points/reconstruct/surface_parts.h"

namespace prefilter {
namespace {

// Share of opposed neighbors at which about 1/10 of all normals are reversed.
constexpr double kMostContradiction = 0.2;

}  // namespace

std::vector<PointAttribute> support_attributes() {
  return {{"distance", false}, {"density", false}};
}

ReconstructReport reconstruct(PointSource* source, const ReconstructOptions& options,
                              MeshSink* sink) {
  check_options(options);
  const bool is_automatic = !options.depth && !options.cell_size;
  CloudLoad load = {source->count().value_or(PointOrder::kMaxPoints), source->attributes().size(),
                    options.basis, options.adaptivity > 0.0};
  const int width = batches_at_once(load, options);
  MeasuredCloud cloud(source, is_automatic || options.check_normals,
                      options.run.part(0.0, 0.08).with_threads(width));
  ReconstructReport report;
  report.phantoms = cloud.phantoms();
  if (options.check_normals && cloud.lacks_normals()) {
    report.normal_fault = NormalFault::kMissing;
    return report;
  }
  load.points = cloud.extent().part.points;
  cloud.exclude_outliers(options.run.part(0.08, 0.1).with_threads(width));
  source = cloud.points();
  const CloudExtent& extent = cloud.extent();
  const SampleGrid grid = grid_of(extent.part.box, cloud.thinned(), options);
  describe_grid(grid, extent, &report);
  report.points += cloud.phantom_points();
  std::optional<NormalProbe> probe;
  if (options.check_normals) {
    probe.emplace(cloud.thinned(), extent.part.box,
                  options.run.part(0.12, 0.13).with_threads(width));
  }
  cloud.thinned() = ThinnedPoints();
  SampleStore store(grid.depth, slab_bits(grid.depth), source->attributes().size(),
                    options.memory_limit / 4, options.folder);
  gather_samples(source, grid, options.run.part(0.13, 0.4).with_threads(width), &store,
                 probe ? &*probe : nullptr);
  if (probe) report.contradiction = probe->contradiction();
  if (report.contradiction > kMostContradiction) {
    report.normal_fault = NormalFault::kContradictory;
    return report;
  }
  const MemoryPlan plan = plan_memory(store, load, options);
  if (!plan.is_held) store.spill();
  report.is_spilled = store.is_spilled();
  ReconstructOptions slab_options = options;
  slab_options.run = options.run.part(0.4, 1.0).with_threads(plan.threads);
  slab_options.memory_limit = plan.left;
  SurfaceParts parts(source, load.attributes, grid, extent, slab_options, plan.keeps_all, &store);
  parts.describe(&report);
  ReconstructOptions mesh_options = slab_options;
  mesh_options.run = slab_options.run.part(0.6, 0.6);
  PartJoiner joiner(grid, parts.slab_height(), load.attributes, mesh_options, sink);
  parts.make(0, parts.count(), slab_options.run.part(0.6, 0.95),
             [&](const SlabMesh& part) { joiner.add(part); });
  joiner.finish(slab_options.run.part(0.95, 1.0), &report);
  check_mesh(options, report);
  return report;
}

}  // namespace prefilter
