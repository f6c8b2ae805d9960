// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/part_joiner.h"

namespace prefilter {
namespace {

bool is_open(const ReconstructOptions& options) { return !options.watertight && !options.trim; }

}  // namespace

std::size_t part_width(std::size_t attribute_count, const ReconstructOptions& options) {
  return attribute_count + (is_open(options) || options.support ? kSupportAttributes : 0);
}

PartJoiner::PartJoiner(const SampleGrid& grid, int slab_height, std::size_t attribute_count,
                       const ReconstructOptions& options, MeshSink* sink)
    : grid_(grid), slab_height_(slab_height), sink_(sink) {
  if (options.adaptivity > 0.0) {
    simplifier_.emplace(
        SimplifierOptions{options.adaptivity * grid.cell,
                          attribute_count + (options.support ? kSupportAttributes : 0),
                          options.support, options.run},
        sink_);
    sink_ = &*simplifier_;
  }
  const std::size_t all = part_width(attribute_count, options);
  if (is_open(options)) {
    cutter_.emplace(TrimOptions(), all, grid.cell, options.support, options.memory_limit,
                    options.folder);
  }
  joiner_.emplace(grid, all, cutter_ ? &*cutter_ : sink_);
}

void PartJoiner::add(const SlabMesh& part) {
  const int side = 1 << grid_.depth;
  const int top = ++next_ * slab_height_;
  joiner_->add(part, top >= side ? side + 1 : top);
  if (cutter_) cutter_->add_far_midpoints(joiner_->far_midpoints());
  MeshSink* const next = cutter_ ? &*cutter_ : sink_;
  next->end_part(joiner_->shared());
}

void PartJoiner::finish(const Run& run, ReconstructReport* report) {
  report->vertices = joiner_->vertices();
  report->triangles = joiner_->triangles();
  if (cutter_) {
    report->trimmed = cutter_->finish(run, sink_);
    report->vertices = cutter_->counts().vertices;
    report->triangles = cutter_->counts().triangles;
    report->is_spilled = report->is_spilled || cutter_->is_spilled();
  }
  if (simplifier_) {
    report->vertices = simplifier_->counts().vertices;
    report->triangles = simplifier_->counts().triangles;
  }
}

}  // namespace prefilter
