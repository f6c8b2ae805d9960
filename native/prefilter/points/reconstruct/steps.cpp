// SPDX-License-Identifier: GPL-3.0-or-later

// Implements the separate steps of a reconstruction. A machine that makes a part recomputes the
// data that all slabs share from the merged cells.
#include "prefilter/points/steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/io/archive.h"
#include "prefilter/base/text.h"
#include "prefilter/points/reconstruct/cloud_grid.h"
#include "prefilter/points/reconstruct/far_outliers.h"
#include "prefilter/points/reconstruct/gather_samples.h"
#include "prefilter/points/reconstruct/memory_plan.h"
#include "prefilter/points/reconstruct/part_files.h"
#include "prefilter/points/reconstruct/part_joiner.h"
#include "prefilter/points/reconstruct/phantom_points.h"
#include "prefilter/points/reconstruct/reconstruct_checks.h"
#include "prefilter/points/reconstruct/sample_store.h"
#include "prefilter/points/reconstruct/surface_parts.h"

namespace prefilter {
namespace {

enum class StepFile { kMeasure, kCounts, kCells, kPart };

ArchiveMark mark_of(StepFile kind, const StepFiles& files) {
  constexpr std::array kNames = {"measure", "counts", "cells", "part"};
  return {kNames[static_cast<std::size_t>(kind)], files.work};
}

constexpr std::size_t kMeasuredNumbers = 29;
constexpr std::size_t kMeasuredCounts = 16;

void write_extent(const CloudExtent& extent, ArchiveWriter* file) {
  const CloudPart& part = extent.part;
  const CloudPart& huge = extent.huge;
  const DroppedPoints& dropped = extent.dropped;
  std::vector<double> numbers = {part.weight, huge.weight};
  std::vector<std::uint64_t> counts = {part.points,       huge.points,        extent.points,
                                       dropped.huge,      dropped.not_finite, dropped.weightless,
                                       dropped.normalless};
  for (std::size_t a = 0; a < 3; ++a) {
    const FloatSteps::Axis& axis = extent.steps.axes()[a];
    numbers.insert(numbers.end(),
                   {part.box.low[a], part.box.high[a], part.mean[a], part.squares[a], axis.largest,
                    huge.box.low[a], huge.box.high[a], huge.mean[a], huge.squares[a]});
    counts.insert(counts.end(), {axis.count, axis.odd, axis.is_wide ? 1U : 0U});
  }
  file->put_all(numbers);
  file->put_all(counts);
}

CloudExtent read_extent(ArchiveReader* file) {
  const std::vector<double> numbers = file->get_all<double>();
  const std::vector<std::uint64_t> counts = file->get_all<std::uint64_t>();
  if (numbers.size() != kMeasuredNumbers || counts.size() != kMeasuredCounts) file->refuse();
  file->end();
  CloudExtent extent;
  std::array<FloatSteps::Axis, 3> axes;
  extent.part.weight = numbers[0];
  extent.huge.weight = numbers[1];
  extent.part.points = counts[0];
  extent.huge.points = counts[1];
  extent.points = counts[2];
  extent.dropped = {counts[4], counts[3], counts[5], counts[6]};
  for (std::size_t a = 0; a < 3; ++a) {
    const double* const own = &numbers[2 + 9 * a];
    const auto take = [&](std::size_t first, CloudPart* part) {
      part->box.low[a] = own[first];
      part->box.high[a] = own[first + 1];
      part->mean[a] = own[first + 2];
      part->squares[a] = own[first + 3];
    };
    take(0, &extent.part);
    take(5, &extent.huge);
    axes[a] = {counts[7 + 3 * a], counts[8 + 3 * a], counts[9 + 3 * a] != 0, own[4]};
  }
  extent.steps = FloatSteps(axes);
  return extent;
}

// Combines the extents of all shares in order.
CloudExtent whole_extent(const StepFiles& files) {
  CloudExtent whole;
  for (const std::string& path : files.measures) {
    ArchiveReader file(path, mark_of(StepFile::kMeasure, files));
    const CloudExtent extent = read_extent(&file);
    whole.part.include(extent.part);
    whole.huge.include(extent.huge);
    whole.steps.add(extent.steps);
    whole.points += extent.points;
    whole.dropped.add(extent.dropped);
  }
  whole.settle_huge();
  check_cloud(whole);
  if (may_have_far_outliers(whole)) {
    throw_invalid(
        "box: none; some points may be far from all others, which steps cannot leave out: give a "
        "box around those that count");
  }
  return whole;
}

CloudLoad load_of(std::size_t points, std::size_t attributes, const ReconstructOptions& options) {
  return {points, attributes, options.basis, options.adaptivity > 0.0};
}

// The first slab of a part.
int begin_of(std::size_t part, std::size_t parts, int slabs) {
  return static_cast<int>(part * static_cast<std::size_t>(slabs) / parts);
}

struct PartHead {
  std::int32_t begin;
  std::int32_t end;
  std::int32_t is_flipped;
  std::int32_t is_room;
  double outliers;
  double residual;
};

}  // namespace

void check_steps(const ReconstructOptions& options) {
  check_options(options);
  if (options.basis != WaveletBasis::kHaar) {
    throw_invalid("wavelet: 'd4' needs all of the surface at once; steps need 'haar'");
  }
  if (!options.depth && !options.cell_size) {
    throw_invalid("depth: none; steps need a depth or a cell size");
  }
}

void measure_step(PointSource* share, std::size_t number, const StepFiles& files,
                  const ReconstructOptions& options) {
  check_steps(options);
  const std::size_t points = share->count().value_or(PointOrder::kMaxPoints);
  const CloudLoad load = load_of(points, share->attributes().size(), options);
  const int width = batches_at_once(load, options);
  RepeatedPositions repeated;
  const Stages stages(options.run, {9, 1});
  const CloudExtent extent =
      measure_cloud(share, stages[0].with_threads(width), nullptr, &repeated);
  const auto phantoms = find_phantoms(repeated, share, stages[1].with_threads(width));
  if (!phantoms.empty()) {
    const PhantomPlace& first = phantoms.front();
    throw_invalid("box: none; " + std::to_string(first.points) + " points are at one place, (" +
                  to_text(first.position[0]) + ", " + to_text(first.position[1]) + ", " +
                  to_text(first.position[2]) +
                  "), as scanners write for no return, which steps cannot leave out: give a box "
                  "around the others, or remove these points");
  }
  ArchiveWriter file(files.measures[number], mark_of(StepFile::kMeasure, files));
  write_extent(extent, &file);
  file.commit();
}

void count_step(PointSource* share, std::size_t number, const StepFiles& files,
                const ReconstructOptions& options) {
  check_steps(options);
  const CloudExtent extent = whole_extent(files);
  const SampleGrid grid = grid_of(extent.part.box, ThinnedPoints(), options);
  const std::size_t attributes = share->attributes().size();
  const CloudLoad load = load_of(extent.part.points, attributes, options);
  SampleStore store(grid.depth, slab_bits(grid.depth), attributes, options.memory_limit / 4,
                    options.folder);
  PointsWithin near(share, extent.part.box);
  gather_samples(extent.dropped.huge > 0 ? &near : share, grid,
                 options.run.with_threads(batches_at_once(load, options)), &store);
  ArchiveWriter file(files.counts[number], mark_of(StepFile::kCounts, files));
  store.save(&file);
  file.commit();
}

void merge_step(const StepFiles& files, const ReconstructOptions& options) {
  check_steps(options);
  std::unique_ptr<SampleStore> all;
  for (std::size_t k = 0; k < files.counts.size(); ++k) {
    const std::unique_ptr<SampleStore> own = SampleStore::open(
        std::make_unique<ArchiveReader>(files.counts[k], mark_of(StepFile::kCounts, files)));
    if (!all) all = own->empty_copy(options.memory_limit / 2, options.folder);
    if (!all->has_shape_of(*own)) throw_invalid("'" + files.counts[k] + "' has other cells");
    for (int s = 0; s < own->slab_count(); ++s) all->add(own->slab(s));
    all->end_cloud();
    options.run.report(0.9 * static_cast<double>(k + 1) / static_cast<double>(files.counts.size()));
  }
  all->finish(options.run.threads());
  ArchiveWriter file(files.cells, mark_of(StepFile::kCells, files));
  all->save(&file);
  file.commit();
  options.run.report(1.0);
}

void part_step(std::size_t number, std::size_t attributes, const StepFiles& files,
               const ReconstructOptions& options) {
  check_steps(options);
  const CloudExtent extent = whole_extent(files);
  const SampleGrid grid = grid_of(extent.part.box, ThinnedPoints(), options);
  const std::unique_ptr<SampleStore> store = SampleStore::open(
      std::make_unique<ArchiveReader>(files.cells, mark_of(StepFile::kCells, files)));
  const SampleStore expected(grid.depth, slab_bits(grid.depth), attributes, 0, "");
  if (!store->has_shape_of(expected)) throw_invalid("'" + files.cells + "' has other cells");
  const CloudLoad load = load_of(extent.part.points, attributes, options);
  const MemoryPlan plan = plan_memory(*store, load, options);
  ReconstructOptions slab_options = options;
  slab_options.run = options.run.with_threads(plan.threads);
  SurfaceParts surface(nullptr, attributes, grid, extent, slab_options, plan.keeps_all,
                       store.get());
  ReconstructReport report;
  surface.describe(&report);
  const int begin = begin_of(number, files.parts.size(), surface.count());
  const int end = begin_of(number + 1, files.parts.size(), surface.count());
  ArchiveWriter file(files.parts[number], mark_of(StepFile::kPart, files));
  file.put_structs(
      std::vector<PartHead>{{begin, end, report.is_flipped ? 1 : 0, report.is_room ? 1 : 0,
                             report.outliers, report.residual}});
  if (begin < end) {
    surface.make(begin, end, slab_options.run.part(0.6, 1.0),
                 [&](const SlabMesh& part) { write_part(part, &file); });
  }
  file.commit();
}

ReconstructReport join_step(std::size_t attributes, const StepFiles& files,
                            const ReconstructOptions& options, MeshSink* sink) {
  check_steps(options);
  const CloudExtent extent = whole_extent(files);
  const SampleGrid grid = grid_of(extent.part.box, ThinnedPoints(), options);
  ReconstructReport report;
  describe_grid(grid, extent, &report);
  ReconstructOptions mesh_options = options;
  mesh_options.run = options.run.part(0.0, 0.0);
  const int slabs = 1 << (grid.depth - slab_bits(grid.depth));
  PartJoiner joiner(grid, 1 << slab_bits(grid.depth), attributes, mesh_options, sink);
  for (std::size_t k = 0; k < files.parts.size(); ++k) {
    ArchiveReader file(files.parts[k], mark_of(StepFile::kPart, files));
    const std::vector<PartHead> heads = file.get_all<PartHead>();
    if (heads.size() != 1 || heads[0].begin != begin_of(k, files.parts.size(), slabs) ||
        heads[0].end != begin_of(k + 1, files.parts.size(), slabs)) {
      throw_invalid("'" + files.parts[k] + "' is a part of another number of parts");
    }
    report.outliers = heads[0].outliers;
    report.residual = heads[0].residual;
    report.is_flipped = heads[0].is_flipped != 0;
    report.is_room = heads[0].is_room != 0;
    for (int s = heads[0].begin; s < heads[0].end; ++s) {
      joiner.add(read_part(part_width(attributes, options), &file));
    }
    file.end();
    options.run.report(0.5 * static_cast<double>(k + 1) / static_cast<double>(files.parts.size()));
  }
  joiner.finish(options.run.part(0.5, 1.0), &report);
  check_mesh(options, report);
  return report;
}

}  // namespace prefilter
