// SPDX-License-Identifier: GPL-3.0-or-later

// Slab by slab (section 4.3.2): the samples of all slabs give the coarse levels of the tree; with
// these a slab's own levels can be made, smoothed, contoured and dropped.
#include "prefilter/reconstruct/reconstruct.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/geometry.h"
#include "prefilter/base/text.h"
#include "prefilter/reconstruct/carried_depth.h"
#include "prefilter/reconstruct/coarse_tree.h"
#include "prefilter/reconstruct/d4_function.h"
#include "prefilter/reconstruct/gather_samples.h"
#include "prefilter/reconstruct/memory_plan.h"
#include "prefilter/reconstruct/mesh_joiner.h"
#include "prefilter/reconstruct/sample_grid.h"
#include "prefilter/reconstruct/sample_store.h"
#include "prefilter/reconstruct/slab_mesh.h"
#include "prefilter/reconstruct/slab_walk.h"
#include "prefilter/reconstruct/slabs.h"
#include "prefilter/reconstruct/stray_points.h"
#include "prefilter/reconstruct/surface_cutter.h"
#include "prefilter/reconstruct/surface_level.h"
#include "prefilter/reconstruct/surface_simplifier.h"
#include "prefilter/reconstruct/whole_samples.h"
#include "prefilter/voxel/voxelize.h"

namespace prefilter {
namespace {

// Slabs are up to 64 cells high; lower where there are many cells, so that those in memory at a
// time are fewer. That follows from the depth alone, as the order of triangles follows from it.
int slab_bits(int depth) { return std::min({depth, 6, std::max(16 - depth, 4)}); }

SampleGrid grid_around(const Box& box, int depth) {
  SampleGrid grid;
  grid.depth = depth;
  int longest = 0;
  for (int a = 1; a < 3; ++a) {
    if (box.size(a) > box.size(longest)) longest = a;
  }
  grid.turn = (longest + 1) % 3;
  const Box cube = cube_around(box, depth);
  check_box(cube, "points");
  grid.low = grid.turned(cube.low);
  grid.cell = cube.size(0) / std::ldexp(1.0, depth);
  return grid;
}

// Of cells that sizes in single precision, and those of messages, are rounded by.
constexpr double kSizeRounding = 1e-6;

// How deep the tree is; `some` of the points tell it where nothing else does.
int depth_for(const Box& box, const ThinnedPoints& some, const ReconstructOptions& options) {
  if (!options.cell_size) {
    if (options.depth) return *options.depth;
    return carried_depth(some, box, options.progress.part(0.1, 0.12), options.threads);
  }
  const auto cell_at = [&](int depth) {
    return cube_around(box, depth).size(0) / std::ldexp(1.0, depth);
  };
  for (int depth = 1; depth <= kMaxTreeDepth; ++depth) {
    if (cell_at(depth) <= *options.cell_size * (1.0 + kSizeRounding)) return depth;
  }
  throw_invalid("cell_size: " + to_text(*options.cell_size) + " would need more than " +
                std::to_string(1 << kMaxTreeDepth) + " cells per axis; use " +
                to_text(cell_at(kMaxTreeDepth) * (1.0 + 1e-5)) + " or more");  // not rounded down
}

// What the function is like.
struct FunctionFindings {
  double left_out = 0.0;   // the weight of outliers
  bool is_inward = false;  // most normals point inward
};

// Values of all slabs in the D4 basis.
FunctionFindings find_d4_trees(PointSource* source, const SampleGrid& grid,
                               const Progress& progress, int threads, Slabs* slabs) {
  slabs->bring(0, slabs->count(), SlabStage::kLeaves);
  D4Function made = make_d4_function(source, grid, *slabs, progress, threads);
  for (int s = 0; s < slabs->count(); ++s) {
    slabs->set_values(s, std::move(made.trees[static_cast<std::size_t>(s)]));
  }
  slabs->coarse = std::move(made.coarse);
  return {made.left_out, made.is_flipped};
}

// Of flat boxes, which hold nothing.
constexpr double kLeastBoxShare = 1e-3;

// The function that is 1 inside and 0 outside: the tree above the slabs, and what these need to
// make their own levels.
FunctionFindings find_function(PointSource* source, const SampleGrid& grid,
                               const ReconstructOptions& options, Slabs* slabs) {
  FunctionFindings found;
  if (options.basis == WaveletBasis::kD4) {
    found = find_d4_trees(source, grid, options.progress.part(0.15, 0.4), options.threads, slabs);
  } else {
    found.left_out = find_coarse_tree(options.progress.part(0.15, 0.35), options.threads, slabs);
    found.is_inward = slabs->coarse.root < 0.0F;
    // What is inside, of the box around the points: their walls enclose most of it, or of
    // themselves.
    slabs->unsolved_mean =
        static_cast<double>(slabs->coarse.root) / std::max(slabs->box_share, kLeastBoxShare);
    slabs->middle = found.is_inward ? -0.5F : 0.5F;
    solve_coarse_tree(slabs->middle, &slabs->coarse);
  }
  if (slabs->coarse.is_empty()) {
    throw_invalid(
        "normals: they contradict each other everywhere; recalculate them, or have them estimated");
  }
  return found;
}

// The mesh, slab by slab, to a joiner, and then to the sink: a cutter, where there is one.
void find_mesh(const SurfaceSamples& surface, const ReconstructOptions& options,
               const SurfaceLevel& level, Slabs* slabs, MeshJoiner* joiner, SurfaceCutter* cutter,
               MeshSink* sink) {
  std::vector<SlabMesh> parts(static_cast<std::size_t>(slabs->count()));
  const auto make = [&](int s) {
    SlabMesh part = mesh_of_slab(surface, options, level, s);
    if (level.is_reversed) {
      for (auto& [a, b, c] : part.contour.mesh.triangles) std::swap(b, c);
    }
    parts[static_cast<std::size_t>(s)] = std::move(part);
  };
  const auto join = [&](int s) {
    const bool is_last = s + 1 == slabs->count();
    SlabMesh& part = parts[static_cast<std::size_t>(s)];
    joiner->add(part, is_last ? (1 << slabs->depth()) + 1 : (s + 1) * slabs->height());
    part = SlabMesh();
    if (cutter != nullptr) cutter->add_far_places(joiner->far_places());
    sink->end_part(joiner->shared());
  };
  for_slabs({SlabStage::kSolved, 1, true}, options.progress.part(0.6, 0.95), options.threads, slabs,
            make, join);
}

// The mesh, cut where it is to be.
void hand_on_mesh(const SampleGrid& grid, const SurfaceSamples& surface,
                  const ReconstructOptions& options, const SurfaceLevel& level, Slabs* slabs,
                  MeshSink* sink, ReconstructReport* report) {
  const bool is_open = !options.watertight && !options.trim;
  const std::size_t all =
      surface.attribute_count + (is_open || options.support ? kSupportAttributes : 0);
  if (!is_open) {
    MeshJoiner joiner(grid, all, sink);
    find_mesh(surface, options, level, slabs, &joiner, nullptr, sink);
    report->vertices = joiner.vertices();
    report->triangles = joiner.triangles();
    return;
  }
  SurfaceCutter cutter(TrimOptions(), all, grid.cell, options.support, options.memory_limit,
                       options.folder);
  MeshJoiner joiner(grid, all, &cutter);
  find_mesh(surface, options, level, slabs, &joiner, &cutter, &cutter);
  report->trimmed = cutter.finish(options.progress.part(0.95, 1.0), sink);
  report->vertices = cutter.counts().vertices;
  report->triangles = cutter.counts().triangles;
  report->is_spilled = report->is_spilled || cutter.is_spilled();
}

// From samples in cells to the mesh. The memory limit is that of the mesh.
void find_surface(PointSource* source, const SampleGrid& grid, const ReconstructOptions& options,
                  double mean_weight, double box_share, bool keeps_all, SampleStore* store,
                  MeshSink* sink, ReconstructReport* report) {
  const std::size_t width = source->attributes().size();
  Slabs slabs(store, grid.depth, grid.depth - slab_bits(grid.depth), width, keeps_all,
              options.threads);
  slabs.mean_weight = mean_weight;
  slabs.box_share = box_share;
  const int largest = find_whole(width, options.progress.part(0.0, 0.15), options.threads, &slabs);
  const FunctionFindings found = find_function(source, grid, options, &slabs);
  report->outliers = found.left_out;
  report->is_flipped = found.is_inward && !options.are_sides_known;
  const SurfaceLevel level =
      find_surface_level(options, found.is_inward, options.progress.part(0.35, 0.6), &slabs);
  report->is_room = level.is_reversed;
  const SurfaceSamples surface = {slabs, width, find_noise(largest, &slabs), grid.cell};
  report->residual = surface.noise.distance;
  if (options.adaptivity == 0.0) {
    hand_on_mesh(grid, surface, options, level, &slabs, sink, report);
    return;
  }
  SurfaceSimplifier simplifier(
      {options.adaptivity * grid.cell, width + (options.support ? kSupportAttributes : 0),
       options.support, options.threads, options.progress.part(0.6, 0.6)},
      sink);
  hand_on_mesh(grid, surface, options, level, &slabs, &simplifier, report);
  report->vertices = simplifier.counts().vertices;
  report->triangles = simplifier.counts().triangles;
}

// Of a cell: coordinates with larger steps leave stairs in the surface.
constexpr double kCoarseStep = 0.25;
constexpr double kLargestIsovalue = 1e30;
constexpr double kLargestTrim = 1e6;
constexpr double kLargestAdaptivity = 1e6;

void check_options(const ReconstructOptions& options) {
  if (options.depth) check_depth(*options.depth, 1, "depth");
  if (options.cell_size && !(*options.cell_size > 0.0 && std::isfinite(*options.cell_size))) {
    throw_invalid("cell_size: " + to_text(*options.cell_size) +
                  "; a length above 0 is needed, or none");
  }
  if (options.isovalue == Isovalue::kGiven &&
      !(std::abs(options.given_isovalue) <= kLargestIsovalue)) {
    throw_invalid("isovalue: " + to_text(options.given_isovalue) +
                  "; a finite number of at most 1e30 is needed");
  }
  if (options.trim && !(*options.trim > 0.0 && *options.trim <= kLargestTrim)) {
    throw_invalid("trim: " + to_text(*options.trim) +
                  "; a number of cells above 0 and up to 1e6 is needed, or none");
  }
}

void check_adaptivity(double adaptivity) {
  if (adaptivity >= 0.0 && adaptivity <= kLargestAdaptivity) return;
  throw_invalid("adaptivity: found " + to_text(adaptivity) + "; allowed are 0 to " +
                to_text(kLargestAdaptivity));
}

void check_cloud(const CloudExtent& extent) {
  if (extent.part.points < 3) {
    throw_invalid(
        "points: " + std::to_string(extent.points) + ", of which " +
        std::to_string(extent.dropped) +
        " are not finite and at most 1e300, or have no normal or no weight; at least 3 are "
        "needed");
  }
  const Box& box = extent.part.box;
  const double longest = std::max({box.size(0), box.size(1), box.size(2)});
  if (!(longest > 0.0)) throw_invalid("points: all coincide; a cloud with an extent is needed");
}

// A mesh of nothing helps nobody.
void check_mesh(const ReconstructOptions& options, const ReconstructReport& report) {
  if (report.triangles > 0) return;
  if (options.trim) {
    throw_invalid("trim: " + to_text(*options.trim) +
                  " cells leave no triangle; more are needed, or none");
  }
  if (report.trimmed.cut > 0.0) {
    throw_invalid("watertight: no point is near the surface; it must be closed");
  }
  if (options.isovalue == Isovalue::kGiven) {
    throw_invalid("isovalue: " + to_text(options.given_isovalue) +
                  " is nowhere; values are about 0 outside and 1 inside");
  }
  throw_invalid("points: the function is nowhere half full; use isovalue \"auto\"");
}

}  // namespace

std::vector<PointAttribute> support_attributes() {
  return {{"distance", false}, {"density", false}};
}

ReconstructReport reconstruct(PointSource* source, const ReconstructOptions& options,
                              MeshSink* sink) {
  check_options(options);
  check_adaptivity(options.adaptivity);
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
  report.points = extent.points;
  report.dropped = extent.dropped;
  report.strays = extent.strays;
  const SampleGrid grid = grid_around(extent.part.box, depth_for(extent.part.box, some, options));
  some = ThinnedPoints();
  report.depth = grid.depth;
  report.cell = grid.cell;
  const double step = extent.steps.step();
  if (step > kCoarseStep * grid.cell) report.float_step = step;
  SampleStore store(grid.depth, slab_bits(grid.depth), source->attributes().size(),
                    options.memory_limit / 4, options.folder);
  gather_samples(source, grid, options.progress.part(0.12, 0.4), width, &store);
  const MemoryPlan plan = plan_memory(store, load, options);
  if (!plan.is_held) store.spill();
  report.is_spilled = store.is_spilled();
  const double mean_weight = extent.part.weight / static_cast<double>(extent.part.points);
  ReconstructOptions rest = options;
  rest.progress = options.progress.part(0.4, 1.0);
  rest.threads = plan.threads;
  rest.memory_limit = plan.left;
  const double side = std::ldexp(grid.cell, grid.depth);
  double box_share = 1.0;
  for (int a = 0; a < 3; ++a) box_share *= extent.part.box.size(a) / side;
  find_surface(source, grid, rest, mean_weight, box_share, plan.keeps_all, &store, sink, &report);
  report.outliers /= extent.part.weight;
  check_mesh(options, report);
  return report;
}

}  // namespace prefilter
