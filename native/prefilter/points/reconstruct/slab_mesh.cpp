// SPDX-License-Identifier: GPL-3.0-or-later

// Smoothing (section 4.3.1) and octree contouring (section 4.3) of one slab.
#include "prefilter/points/reconstruct/slab_mesh.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/points/reconstruct/fit_values.h"
#include "prefilter/points/reconstruct/slab_support.h"
#include "prefilter/points/reconstruct/thin_parts.h"
#include "prefilter/voxels/contour/contour_slab.h"
#include "prefilter/wavelet/smooth.h"

namespace prefilter {
namespace {

// Shifts the mean to 1/2 for functions that are 0 or 1 except in cells that the surface crosses:
// the offset of the mean applies to all values.
void center_occupancies(float mean, CellTree* tree) {
  for (TreeLevel& blocks : tree->levels) {
    for (OctantValues& block : blocks.blocks) {
      for (float& value : block) value = std::clamp(value + 0.5F - mean, 0.0F, 1.0F);
    }
  }
}

// Sample indices around a slab, built per depth on demand.
class SampleDepths {
 public:
  SampleDepths(const Slabs& slabs, int s)
      : slabs_(slabs), s_(s), indices_(static_cast<std::size_t>(slabs.depth()) + 1) {}

  const SampleIndex& at(int k) {
    auto& index = indices_[static_cast<std::size_t>(k)];
    if (!index) index = std::make_unique<SampleIndex>(samples_around(slabs_, s_, k, kFitOctants));
    return *index;
  }

 private:
  const Slabs& slabs_;
  int s_;
  std::vector<std::unique_ptr<SampleIndex>> indices_;
};

SampleFit fit_of(const SurfaceSamples& surface, SampleDepths* samples) {
  return SampleFit([samples](int k) -> const SampleIndex& { return samples->at(k); },
                   surface.slabs.depth(), surface.noise);
}

// Side of the largest leaves whose values are fitted; beside larger ones vertices are moved
// instead, since the values that affect these leaves lie within the adjacent slabs.
int largest_fitted(const Slabs& slabs, const ReconstructOptions& options) {
  if (!options.fit || !options.smooth || slabs.target == 0.0F) return 0;
  return slabs.count() == 1 ? slabs.height() : std::max(1, slabs.height() / 16);
}

ContourSlab contour_of_slab(const SurfaceSamples& surface, const ReconstructOptions& options,
                            const SurfaceLevel& level, int s, SampleDepths* samples) {
  const Slabs& slabs = surface.slabs;
  HeightRange heights = {s * slabs.height(), (s + 1) * slabs.height()};
  if (s + 1 == slabs.count()) ++heights.high;
  const int largest = largest_fitted(slabs, options);
  CellTree tree = tree_around(slabs, s, largest > 0 ? kFitOctants : kContourOctants, level.scale);
  if (options.smooth) smooth_leaves(&tree);
  const bool are_occupancies = options.basis == WaveletBasis::kHaar && !options.smooth;
  float isovalue = level.isovalue;
  if (are_occupancies && options.isovalue == Isovalue::kMean) {
    center_occupancies(isovalue, &tree);
    isovalue = 0.5F;
  }
  if (largest > 0) {
    const SampleFit fit = fit_of(surface, samples);
    restore_thin_parts(fit, isovalue, {heights, largest}, &tree);
    fit_values(fit, isovalue, {heights, largest}, &tree);
  }
  ContourSlab contour = contour_slab(
      tree, isovalue, are_occupancies ? Interpolant::kOccupancy : Interpolant::kLinear, heights);
  const int side = 1 << slabs.depth();
  for (Vector3& p : contour.mesh.positions) {
    for (double& x : p) x *= side;
  }
  return contour;
}

// Blends the attributes of the samples near a point, which is in finest cells and next to leaves of
// depth k, at the greatest depth up to k that has samples there.
void find_attributes(const Vector3& point, int k, int finest, SampleDepths* samples,
                     std::span<float> attributes) {
  for (; k > 0; --k) {
    const double shrink = std::ldexp(1.0, k - finest);
    const Vector3 in_level = {point[0] * shrink, point[1] * shrink, point[2] * shrink};
    if (blend_attributes(samples->at(k), in_level, attributes)) return;
  }
}

// The line of a vertex, from the center of its leaf to the center beyond the face.
FitLine line_of(const VertexPlace& place, const Vector3& position, int depth) {
  // Minimum distance between a vertex and the centers, in sides of the leaf.
  constexpr double kMinCenterGap = 0.01;
  const double side = std::ldexp(1.0, depth - place.depth);
  const auto axis = static_cast<std::size_t>(place.face / 2);
  FitLine line;
  for (std::size_t a = 0; a < 3; ++a) {
    line.start[a] = (place.leaf[a] + 0.5) * side;
    line.direction[a] = position[a] - line.start[a];
  }
  const double along = std::abs(line.direction[axis]);
  if (along > kMinCenterGap * side) {
    for (double& x : line.direction) x *= side / along;
  } else {
    line.direction = {};
    line.direction[axis] = (place.face & 1) != 0 ? side : -side;
  }
  line.low = kMinCenterGap;
  line.high = std::max(1.0 - kMinCenterGap, along / side);
  return line;
}

// Moves the vertices beside leaves larger than `largest_still`, and blends attributes for all.
void follow_samples(const SurfaceSamples& surface, std::optional<int> largest_still,
                    SampleDepths* samples, SlabMesh* slab) {
  const bool is_solved = surface.slabs.target != 0.0F;
  const int depth = surface.slabs.depth();
  const std::size_t width = surface.attribute_count;
  std::vector<Vector3>& positions = slab->contour.mesh.positions;
  const std::vector<VertexPlace>& places = slab->contour.places;
  slab->attributes.resize(positions.size() * width);
  const SampleFit fit = fit_of(surface, samples);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const int k = v < places.size() ? places[v].depth : depth;
    if (largest_still && v < places.size() && 1 << (depth - k) > *largest_still) {
      const FitLine line = line_of(places[v], positions[v], depth);
      fit.move(k, is_solved ? &line : nullptr, &positions[v]);
    }
    if (width > 0) {
      find_attributes(positions[v], k, depth, samples,
                      {slab->attributes.data() + v * width, width});
    }
  }
}

}  // namespace

SampleIndex samples_around(const Slabs& slabs, int s, int k, int margin) {
  if (k < slabs.top()) {
    SampleIndex index(k, 0, 1 << k);
    index.add(slabs.whole.at(k));
    index.finish();
    return index;
  }
  const int height = 1 << (k - slabs.top());
  SampleIndex index(k, std::max(0, s * height - margin),
                    std::min(1 << k, (s + 1) * height + margin));
  for (int t = s - 1; t <= s + 1; ++t) {
    if (slabs.samples(t) != nullptr) index.add(slabs.samples(t)->at(k));
  }
  index.finish();
  return index;
}

SampleNoise find_noise(int s, Slabs* slabs) {
  constexpr std::size_t kCells = 4096;  // about as many are measured
  const int depth = slabs->depth();
  if (depth == slabs->top()) return {};
  slabs->advance_to(s - 1, s + 2, SlabStage::kLeaves);
  const SampleLevel& level = slabs->samples(s)->at(depth);
  const SampleIndex coarser = samples_around(*slabs, s, depth - 1, 2);
  const std::size_t step = std::max<std::size_t>(1, level.size() / kCells);
  std::vector<SampleCell> cells;
  for (std::size_t i = 0; i < level.size(); i += step) {
    if (level.leaf[i] == depth) cells.push_back(level.samples.cells[i]);
  }
  const SampleNoise noise = measure_noise(cells, coarser, slabs->mean_weight);
  slabs->drop_below(slabs->count(), false);
  return noise;
}

SlabMesh mesh_of_slab(const SurfaceSamples& surface, const ReconstructOptions& options,
                      const SurfaceLevel& level, int s) {
  SlabMesh slab;
  SampleDepths samples(surface.slabs, s);
  slab.contour = contour_of_slab(surface, options, level, s, &samples);
  if (options.fit || surface.attribute_count > 0) {
    const int largest = largest_fitted(surface.slabs, options);
    follow_samples(surface, options.fit ? std::optional(largest) : std::nullopt, &samples, &slab);
  }
  if (options.support || (!options.watertight && !options.trim)) {
    add_support(surface, TrimOptions().distance, level.scale < 0.0F ? -1.0 : 1.0, s, &slab);
  }
  if (options.trim) mark_far_vertices(surface.slabs, s, *options.trim, &slab);
  return slab;
}

void mark_far_vertices(const Slabs& slabs, int s, double limit, SlabMesh* slab) {
  constexpr double kMaxReachCells = 8.0;  // a larger limit is tested in coarser cells
  int k = slabs.depth();
  // Cells of the adjacent slabs are in memory as well, but no others.
  while (k > 0 && (limit > kMaxReachCells ||
                   (k > slabs.top() && std::ceil(limit) > (1 << (k - slabs.top()))))) {
    --k;
    limit /= 2.0;
  }
  const int reach = static_cast<int>(std::ceil(limit));
  const SampleIndex index = samples_around(slabs, s, k, reach + 2);
  const double cell_size = std::ldexp(1.0, slabs.depth() - k);
  for (const Vector3& position : slab->contour.mesh.positions) {
    const Vector3 p = {position[0] / cell_size, position[1] / cell_size, position[2] / cell_size};
    bool is_near = false;
    const auto look = [&](const SampleCells& cells, std::size_t i, const Vector3& corner) {
      const SampleCell& cell = cells.cells[i];
      double squared = 0.0;
      for (std::size_t a = 0; a < 3; ++a) {
        const double x = corner[a] + static_cast<double>(cell.position[a] / cell.weight) - p[a];
        squared += x * x;
      }
      is_near = is_near || squared <= limit * limit;
    };
    index.for_near(p, std::min(1, reach), look);
    if (!is_near) index.for_near(p, reach, look);
    slab->is_trimmed.push_back(is_near ? 0 : 1);
  }
}

}  // namespace prefilter
