// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/surface_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/points/reconstruct/coarse_tree.h"
#include "prefilter/points/reconstruct/d4_function.h"
#include "prefilter/points/reconstruct/slab_walk.h"
#include "prefilter/points/reconstruct/whole_samples.h"

namespace prefilter {
namespace {

// Findings about the function.
struct FunctionFindings {
  double left_out = 0.0;   // the weight of outliers
  bool is_inward = false;  // most normals point inward
};

// Computes the values of all slabs in the D4 basis.
FunctionFindings find_d4_trees(PointSource* source, const SampleGrid& grid, const Run& run,
                               Slabs* slabs) {
  slabs->advance_to(0, slabs->count(), SlabStage::kLeaves);
  D4Function made = make_d4_function(source, grid, *slabs, run);
  for (int s = 0; s < slabs->count(); ++s) {
    slabs->set_values(s, std::move(made.trees[static_cast<std::size_t>(s)]));
  }
  slabs->coarse = std::move(made.coarse);
  return {made.left_out, made.is_flipped};
}

// Lower limit for the share of flat boxes, whose volume is 0.
constexpr double kMinBoxShare = 1e-3;

// Computes the function that is 1 inside and 0 outside: the coarse tree, and the data from which
// slabs compute their own levels.
FunctionFindings find_function(PointSource* source, const SampleGrid& grid,
                               const ReconstructOptions& options, Slabs* slabs) {
  FunctionFindings findings;
  if (options.basis == WaveletBasis::kD4) {
    findings = find_d4_trees(source, grid, options.run.part(0.15, 0.4), slabs);
  } else {
    findings.left_out = build_coarse_tree(options.run.part(0.15, 0.35), slabs);
    findings.is_inward = slabs->coarse.root < 0.0F;
    // The share of the box around the points that is inside. In a room the walls enclose most of
    // the box; for a solid object they enclose the object.
    slabs->unsolved_mean =
        static_cast<double>(slabs->coarse.root) / std::max(slabs->box_share, kMinBoxShare);
    slabs->target = findings.is_inward ? -0.5F : 0.5F;
    solve_coarse_tree(slabs->target, &slabs->coarse);
  }
  if (slabs->coarse.is_empty()) {
    throw_invalid(
        "normals: they contradict each other everywhere; recalculate them, or have them estimated");
  }
  return findings;
}

// Volume of the box around the points, as a share of the root's volume.
double box_share(const SampleGrid& grid, const Box& box) {
  const double side = std::ldexp(grid.cell, grid.depth);
  double share = 1.0;
  for (int a = 0; a < 3; ++a) share *= box.size(a) / side;
  return share;
}

}  // namespace

int slab_bits(int depth) { return std::min({depth, 6, std::max(16 - depth, 4)}); }

SurfaceParts::SurfaceParts(PointSource* source, std::size_t attribute_count, const SampleGrid& grid,
                           const CloudExtent& extent, const ReconstructOptions& options,
                           bool keeps_all, SampleStore* store)
    : options_(options),
      slabs_(store, grid.depth, grid.depth - slab_bits(grid.depth), attribute_count, keeps_all,
             options.run.threads()),
      attribute_count_(attribute_count),
      cell_(grid.cell) {
  slabs_.mean_weight = extent.part.weight / static_cast<double>(extent.part.points);
  slabs_.box_share = box_share(grid, extent.part.box);
  const int largest = compute_whole_samples(attribute_count, options.run.part(0.0, 0.15), &slabs_);
  const FunctionFindings findings = find_function(source, grid, options, &slabs_);
  outliers_ = findings.left_out / extent.part.weight;
  is_flipped_ = findings.is_inward && !options.are_sides_known;
  level_ = find_surface_level(options, findings.is_inward, options.run.part(0.35, 0.6), &slabs_);
  noise_ = find_noise(largest, &slabs_);
}

void SurfaceParts::make(int begin, int end, const Run& run,
                        const std::function<void(const SlabMesh&)>& use) {
  const SurfaceSamples surface = {slabs_, attribute_count_, noise_, cell_};
  std::vector<SlabMesh> parts(static_cast<std::size_t>(slabs_.count()));
  const auto make_part = [&](int s) {
    SlabMesh part = mesh_of_slab(surface, options_, level_, s);
    if (level_.is_reversed) {
      for (auto& [a, b, c] : part.contour.mesh.triangles) std::swap(b, c);
    }
    parts[static_cast<std::size_t>(s)] = std::move(part);
  };
  const auto hand_on = [&](int s) {
    use(std::exchange(parts[static_cast<std::size_t>(s)], SlabMesh()));
  };
  for_slabs({SlabStage::kSolved, 1, true, begin, end}, run, &slabs_, make_part, hand_on);
}

void SurfaceParts::describe(ReconstructReport* report) const {
  report->outliers = outliers_;
  report->is_flipped = is_flipped_;
  report->is_room = level_.is_reversed;
  report->residual = noise_.distance;
}

}  // namespace prefilter
