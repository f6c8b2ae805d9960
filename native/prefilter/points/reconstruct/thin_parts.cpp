// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/thin_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "prefilter/base/geometry.h"
#include "prefilter/points/reconstruct/sample_cell.h"
#include "prefilter/points/reconstruct/tree_leaf.h"

namespace prefilter {
namespace {

// Margin around the heights in which values are changed, in sides of a leaf: fit_values reads
// these.
constexpr int kThinMargin = 8;
// Range of 1 - |mean normal|^2: 1/2 at creases, nearly 1 on a plate. Noise stays below it, so noisy
// samples are trusted only as far as the fit trusts them.
constexpr float kCreaseCancellation = 0.5F;
constexpr float kThinCancellation = 0.9F;
// Regularization toward the present value, relative to a sample in the middle of its leaf.
constexpr float kThinDamping = 0.05F;

// Squared length of a mean; squares of the weight could overflow a float.
float squared_mean(const std::array<float, 3>& sum, float weight) {
  float squared = 0.0F;
  for (const float x : sum) squared += (x / weight) * (x / weight);
  return squared;
}

// Sums over the samples in and around a leaf.
struct LeafSums {
  std::array<float, 3> normal{};
  float weight = 0.0F;
  float change = 0.0F;
  float change_weight = 0.0F;

  // How much the samples resemble those of a thin part, from 0 to 1.
  float thinness() const {
    if (!(weight > 0.0F)) return 0.0F;
    const float cancelled = 1.0F - squared_mean(normal, weight);
    return std::clamp((cancelled - kCreaseCancellation) / (kThinCancellation - kCreaseCancellation),
                      0.0F, 1.0F);
  }
};

class ThinPartRestorer {
 public:
  ThinPartRestorer(const SampleFit& fit, const FitRange& range, CellTree* tree)
      : fit_(fit), range_(range), tree_(tree) {
    for (const TreeLevel& level : tree->levels) sums_.emplace_back(8 * level.size());
  }

  void add_normals() {
    for_samples([&](const SampleCell& cell, const TreeCell& leaf) {
      for_neighbors(leaf.depth, cell, [&](LeafSums& sums, float share) {
        sums.weight += share * cell.weight;
        for (std::size_t a = 0; a < 3; ++a) sums.normal[a] += share * cell.normal[a];
      });
    });
  }

  void add_changes(float isovalue) {
    for_samples([&](const SampleCell& cell, const TreeCell& leaf) {
      const float change = trust_in_sample(cell, leaf) * (isovalue - value_at(leaf.depth, cell));
      // Where the cell's normals cancel each other, its mean sample lies on no surface.
      const float coherence = squared_mean(cell.normal, cell.weight);
      for_neighbors(leaf.depth, cell, [&](LeafSums& sums, float share) {
        sums.change += coherence * share * change;
        sums.change_weight += coherence * share;
      });
    });
  }

  void apply_changes() {
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      for (std::size_t i = 0; i < sums_[k].size(); ++i) {
        const LeafSums& sums = sums_[k][i];
        if (!(sums.weight > 0.0F)) continue;
        tree_->levels[k].blocks[i / 8][i % 8] += sums.change / (sums.change_weight + kThinDamping);
      }
    }
  }

 private:
  // Calls visit(cell, leaf) for the sample cells that are leaves within the range.
  template <typename Visit>
  void for_samples(const Visit& visit) const {
    const int depth = tree_->depth();
    for (int k = 1; k <= depth; ++k) {
      const int size = 1 << (depth - k);
      if (size > range_.largest) continue;
      fit_.samples(k).for_all([&](const SampleCell& cell) {
        const CellPosition at = cell_position(cell.key);
        const int low = at[2] * size;
        if (low + (kThinMargin + 1) * size < range_.heights.low ||
            low - kThinMargin * size > range_.heights.high) {
          return;
        }
        const std::optional<TreeCell> own = cell_at(*tree_, k, at);
        if (own && own->is_leaf && own->depth == k) visit(cell, *own);
      });
    }
  }

  // Calls visit(around, share) for the leaf of a cell and the leaves around it that are no smaller;
  // shares are those of a tent function.
  template <typename Visit>
  void for_neighbors(int k, const SampleCell& cell, const Visit& visit) {
    const CellPosition at = cell_position(cell.key);
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const std::optional<TreeCell> neighbor =
              cell_at(*tree_, k, {at[0] + dx, at[1] + dy, at[2] + dz});
          if (!neighbor || !neighbor->is_leaf) continue;
          const int steps = std::abs(dx) + std::abs(dy) + std::abs(dz);
          visit(sums_[neighbor->level()][neighbor->cell], 1.0F / static_cast<float>(1 << steps));
        }
      }
    }
  }

  float trust_in_sample(const SampleCell& cell, const TreeCell& leaf) const {
    const CellPosition at = cell_position(cell.key);
    const double size = std::ldexp(1.0, tree_->depth() - leaf.depth);
    Vector3 point;
    for (std::size_t a = 0; a < 3; ++a) {
      point[a] = size * (at[a] + static_cast<double>(cell.position[a] / cell.weight));
    }
    const float thinness = sums_[leaf.level()][leaf.cell].thinness();
    const std::optional<LocalSurface> surface = fit_.surface_near(leaf.depth, point);
    return surface ? std::max(thinness, static_cast<float>(surface->trust)) : thinness;
  }

  // The function at the mean sample of a cell, interpolated trilinearly between cell centers.
  float value_at(int k, const SampleCell& cell) const {
    const CellPosition at = cell_position(cell.key);
    CellPosition first;
    std::array<float, 3> off;
    for (std::size_t a = 0; a < 3; ++a) {
      const float p = cell.position[a] / cell.weight - 0.5F;
      first[a] = at[a] - (p < 0.0F ? 1 : 0);
      off[a] = p < 0.0F ? p + 1.0F : p;
    }
    float sum = 0.0F;
    for (int o = 0; o < 8; ++o) {
      const std::array<int, 3> step = {o & 1, (o >> 1) & 1, o >> 2};
      const std::optional<TreeCell> corner_cell =
          cell_at(*tree_, k, {first[0] + step[0], first[1] + step[1], first[2] + step[2]});
      if (!corner_cell) continue;
      float value = value_of(*corner_cell, *tree_);
      for (std::size_t a = 0; a < 3; ++a) value *= step[a] != 0 ? off[a] : 1.0F - off[a];
      sum += value;
    }
    return sum;
  }

  const SampleFit& fit_;
  FitRange range_;
  CellTree* tree_;
  std::vector<std::vector<LeafSums>> sums_;
};

}  // namespace

void restore_thin_parts(const SampleFit& fit, float isovalue, const FitRange& range,
                        CellTree* tree) {
  ThinPartRestorer restorer(fit, range, tree);
  restorer.add_normals();
  restorer.add_changes(isovalue);
  restorer.apply_changes();
}

}  // namespace prefilter
