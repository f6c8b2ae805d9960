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

// The derivative is not that of a linear function: what the first round leaves, the second finds.
constexpr int kValueRounds = 2;
// What counts for a leaf before the last round: neighbors of half its size, in sides of these.
constexpr int kReach = 3;

// How much it counts that a value stays, beside a line straight across the surface: lines that
// hardly cross it would move it without end.
constexpr float kStill = 0.05F;

// A leaf, and how high it lies, in sides of it.
struct Leaf {
  TreeCell place;
  std::int32_t height;
};

// The leaf that is or holds a cell; none outside of the root.
std::optional<Leaf> find_leaf(const CellTree& tree, int depth, const CellCoordinates& at) {
  const std::optional<TreeCell> found = cell_at(tree, depth, at);
  if (!found) return std::nullopt;
  return Leaf{*found, at[2] >> (depth - found->depth)};
}

// How a leaf's value is to change, by the lines from its center to those of its neighbors: those
// across the surface count most.
struct Change {
  float sum = 0.0F;
  float weight = 0.0F;
};

class ValueFit {
 public:
  ValueFit(const SampleFit& fit, const FitRange& range, CellTree* tree)
      : fit_(fit), range_(range), tree_(tree) {
    for (const TreeLevel& level : tree->levels) changes_.emplace_back(8 * level.size());
  }

  // `later`: how many rounds follow.
  void find_changes(float isovalue, int later) {
    const ContourTree contour(*tree_, isovalue, Progress(), 1);
    reach_ = kReach * later;
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
        Change& change = changes_[k][i];
        if (change.weight > 0.0F) value(k, i) += change.sum / (change.weight + kStill);
        change = {};
      }
    }
  }

 private:
  float& value(std::size_t level, std::size_t cell) {
    return tree_->levels[level].blocks[cell / 8][cell % 8];
  }
  float value(const Leaf& leaf) const { return value_of(leaf.place, *tree_); }

  // Whether the value of a leaf counts for the heights, now or in a later round.
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
    // Where holes are filled, much smaller leaves may be farther away than values are known.
    if (near->place.depth - far->place.depth > 1) return;
    const std::optional<LocalSurface> surface = fit_.surface_near(place.depth, vertex);
    if (!surface) return;
    // The surface moves by -distance along its normal, which is -distance / slope along the line,
    // if the value changes by as much times its derivative. Weights are the slope's square.
    const float derivative = is_high ? value(*far) - value(*near) : value(*near) - value(*far);
    const auto slope = static_cast<float>(surface->normal[axis]);
    const auto distance = static_cast<float>(surface->trust * surface->distance);
    for (const Leaf& leaf : {*near, *far}) {
      if (!counts(leaf)) continue;
      Change& change = changes_[leaf.place.level()][leaf.place.cell];
      change.sum += derivative * slope * distance;
      change.weight += slope * slope;
    }
  }

  const SampleFit& fit_;
  FitRange range_;
  int reach_ = 0;
  CellTree* tree_;
  std::vector<std::vector<Change>> changes_;
};

}  // namespace

void fit_values(const SampleFit& fit, float isovalue, const FitRange& range, CellTree* tree) {
  ValueFit values(fit, range, tree);
  for (int later = kValueRounds - 1; later >= 0; --later) {
    values.find_changes(isovalue, later);
    values.apply_changes();
  }
}

}  // namespace prefilter
