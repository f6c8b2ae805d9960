// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/fit_values.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "prefilter/points/reconstruct/tree_leaf.h"
#include "prefilter/voxels/contour/contour_tree.h"
#include "prefilter/voxels/contour/root_frame.h"
#include "prefilter/voxels/contour/surface_vertices.h"

namespace prefilter {
namespace {

// The value's derivative is only approximately linear, so a second round corrects the first one's
// residual.
constexpr int kValueRounds = 2;
// Margin, in sides of a leaf, from which each later round reads values: neighbors of half the size
// affect a leaf.
constexpr int kRoundMargin = 3;

// Regularization toward the present value, relative to a line that crosses the surface at a right
// angle; lines that hardly cross it would change the value without bound.
constexpr float kValueDamping = 0.05F;

// A leaf, and its height in units of its side.
struct Leaf {
  TreeCell place;
  std::int32_t height;
};

// The leaf that is or contains a cell; none outside the root.
std::optional<Leaf> find_leaf(const CellTree& tree, int depth, const CellCoordinates& at) {
  const std::optional<TreeCell> cell = cell_at(tree, depth, at);
  if (!cell) return std::nullopt;
  return Leaf{*cell, at[2] >> (depth - cell->depth)};
}

// Accumulated change of a leaf's value, from the lines between its center and those of its
// neighbors, weighted by the squared slope of the surface along the line.
struct ValueChange {
  float sum = 0.0F;
  float weight = 0.0F;
};

class ValueFit {
 public:
  ValueFit(const SampleFit& fit, const FitRange& range, CellTree* tree)
      : fit_(fit), range_(range), tree_(tree) {
    for (const TreeLevel& level : tree->levels) changes_.emplace_back(8 * level.size());
  }

  // `rounds_left` is the number of rounds after this one.
  void find_changes(float isovalue, int rounds_left) {
    const ContourTree contour(*tree_, isovalue, Run(1));
    reach_ = kRoundMargin * rounds_left;
    const int margin = (reach_ + 1) * range_.largest;
    const SurfaceVertices vertices(contour, RootFrame({{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}}),
                                   Interpolant::kLinear,
                                   {range_.heights.low - margin, range_.heights.high + margin});
    const double side = std::ldexp(1.0, tree_->depth());
    for (std::size_t v = 0; v < vertices.places().size(); ++v) {
      add_line(vertices.places()[v], side * vertices.positions()[v]);
    }
  }

  void apply_changes() {
    for (std::size_t k = 0; k < changes_.size(); ++k) {
      for (std::size_t i = 0; i < changes_[k].size(); ++i) {
        ValueChange& change = changes_[k][i];
        if (change.weight > 0.0F) value(k, i) += change.sum / (change.weight + kValueDamping);
        change = {};
      }
    }
  }

 private:
  float& value(std::size_t level, std::size_t cell) {
    return tree_->levels[level].blocks[cell / 8][cell % 8];
  }
  float value(const Leaf& leaf) const { return value_of(leaf.place, *tree_); }

  // Whether the value of a leaf affects the heights, in this round or a later one.
  bool counts(const Leaf& leaf) const {
    const int size = 1 << (tree_->depth() - leaf.place.depth);
    const int low = leaf.height * size;
    return size <= range_.largest && low + (reach_ + 1) * size >= range_.heights.low &&
           low - reach_ * size <= range_.heights.high;
  }

  void add_line(const VertexPlace& place, const Vector3& vertex) {
    const auto axis = static_cast<std::size_t>(place.face / 2);
    const bool is_high = (place.face & 1) != 0;
    CellCoordinates beyond = place.leaf;
    beyond[axis] += is_high ? 1 : -1;
    const std::optional<Leaf> near = find_leaf(*tree_, place.depth, place.leaf);
    const std::optional<Leaf> far = find_leaf(*tree_, place.depth, beyond);
    if (!near || !far || !(counts(*near) || counts(*far))) return;
    // Where holes are filled, much smaller leaves may lie outside the known values.
    if (near->place.depth - far->place.depth > 1) return;
    const std::optional<LocalSurface> surface = fit_.surface_near(place.depth, vertex);
    if (!surface) return;
    // To move by -distance along its normal, the surface must move by -distance / slope along the
    // line, so the value must change by that times its derivative. Weights are squared slopes.
    const float derivative = is_high ? value(*far) - value(*near) : value(*near) - value(*far);
    const auto slope = static_cast<float>(surface->normal[axis]);
    const auto distance = static_cast<float>(surface->trust * surface->distance);
    for (const Leaf& leaf : {*near, *far}) {
      if (!counts(leaf)) continue;
      ValueChange& change = changes_[leaf.place.level()][leaf.place.cell];
      change.sum += derivative * slope * distance;
      change.weight += slope * slope;
    }
  }

  const SampleFit& fit_;
  FitRange range_;
  int reach_ = 0;
  CellTree* tree_;
  std::vector<std::vector<ValueChange>> changes_;
};

}  // namespace

void fit_values(const SampleFit& fit, float isovalue, const FitRange& range, CellTree* tree) {
  ValueFit values(fit, range, tree);
  for (int rounds_left = kValueRounds - 1; rounds_left >= 0; --rounds_left) {
    values.find_changes(isovalue, rounds_left);
    values.apply_changes();
  }
}

}  // namespace prefilter
