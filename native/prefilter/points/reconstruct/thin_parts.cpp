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

// How far from the heights values are changed, in sides of a leaf: what fit_values reads.
constexpr int kThinReach = 8;
// Of 1 less the squared length of the mean normal: at creases it is 1/2, of a plate nearly 1. Noise
// stays below, so that where there is some the samples are trusted as for the fit.
constexpr float kOfCrease = 0.5F;
constexpr float kOfThinPart = 0.9F;
// How much it counts that a value stays, beside a sample in the middle of its leaf.
constexpr float kThinStill = 0.05F;

// The squared length of a mean; squares of weights may be beyond what floats hold.
float squared_mean(const std::array<float, 3>& sum, float weight) {
  float squared = 0.0F;
  for (const float x : sum) squared += (x / weight) * (x / weight);
  return squared;
}

// What the samples in and around a leaf say.
struct Around {
  std::array<float, 3> normal{};
  float weight = 0.0F;
  float change = 0.0F;
  float change_weight = 0.0F;

  // How thin the part is that they are of, from 0 to 1.
  float thinness() const {
    if (!(weight > 0.0F)) return 0.0F;
    const float cancelled = 1.0F - squared_mean(normal, weight);
    return std::clamp((cancelled - kOfCrease) / (kOfThinPart - kOfCrease), 0.0F, 1.0F);
  }
};

class Restorer {
 public:
  Restorer(const SampleFit& fit, const FitRange& range, CellTree* tree)
      : fit_(fit), range_(range), tree_(tree) {
    for (const TreeLevel& level : tree->levels) around_.emplace_back(8 * level.size());
  }

  void add_normals() {
    for_samples([&](const SampleCell& cell, const TreeCell& leaf) {
      for_around(leaf.depth, cell, [&](Around& around, float share) {
        around.weight += share * cell.weight;
        for (std::size_t a = 0; a < 3; ++a) around.normal[a] += share * cell.normal[a];
      });
    });
  }

  void add_changes(float isovalue) {
    for_samples([&](const SampleCell& cell, const TreeCell& leaf) {
      const float change = trust_in_sample(cell, leaf) * (isovalue - value_at(leaf.depth, cell));
      // Where normals of the cell cancel each other, the mean sample is on no surface.
      const float coherence = squared_mean(cell.normal, cell.weight);
      for_around(leaf.depth, cell, [&](Around& around, float share) {
        around.change += coherence * share * change;
        around.change_weight += coherence * share;
      });
    });
  }

  void apply_changes() {
    for (std::size_t k = 0; k < around_.size(); ++k) {
      for (std::size_t i = 0; i < around_[k].size(); ++i) {
        const Around& around = around_[k][i];
        if (!(around.weight > 0.0F)) continue;
        tree_->levels[k].blocks[i / 8][i % 8] +=
            around.change / (around.change_weight + kThinStill);
      }
    }
  }

 private:
  // Calls visit(cell, leaf) for the cells of samples that are leaves, and count.
  template <typename Visit>
  void for_samples(const Visit& visit) const {
    const int depth = tree_->depth();
    for (int k = 1; k <= depth; ++k) {
      const int size = 1 << (depth - k);
      if (size > range_.largest) continue;
      fit_.samples(k).for_all([&](const SampleCell& cell) {
        const CellPosition at = cell_position(cell.key);
        const int low = at[2] * size;
        if (low + (kThinReach + 1) * size < range_.heights.low ||
            low - kThinReach * size > range_.heights.high) {
          return;
        }
        const std::optional<TreeCell> own = cell_at(*tree_, k, at);
        if (own && own->is_leaf && own->depth == k) visit(cell, *own);
      });
    }
  }

  // Calls visit(around, share) for the leaf of a cell and those around it that are no smaller;
  // shares are those of a tent.
  template <typename Visit>
  void for_around(int k, const SampleCell& cell, const Visit& visit) {
    const CellPosition at = cell_position(cell.key);
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const std::optional<TreeCell> found =
              cell_at(*tree_, k, {at[0] + dx, at[1] + dy, at[2] + dz});
          if (!found || !found->is_leaf) continue;
          const int steps = std::abs(dx) + std::abs(dy) + std::abs(dz);
          visit(around_[found->level()][found->cell], 1.0F / static_cast<float>(1 << steps));
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
    const float thinness = around_[leaf.level()][leaf.cell].thinness();
    const std::optional<LocalSurface> surface = fit_.surface_near(leaf.depth, point);
    return surface ? std::max(thinness, static_cast<float>(surface->trust)) : thinness;
  }

  // The function at the mean sample of a cell: trilinear between centers.
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
      const std::optional<TreeCell> found =
          cell_at(*tree_, k, {first[0] + step[0], first[1] + step[1], first[2] + step[2]});
      if (!found) continue;
      float value = value_of(*found, *tree_);
      for (std::size_t a = 0; a < 3; ++a) value *= step[a] != 0 ? off[a] : 1.0F - off[a];
      sum += value;
    }
    return sum;
  }

  const SampleFit& fit_;
  FitRange range_;
  CellTree* tree_;
  std::vector<std::vector<Around>> around_;
};

}  // namespace

void restore_thin_parts(const SampleFit& fit, float isovalue, const FitRange& range,
                        CellTree* tree) {
  Restorer restorer(fit, range, tree);
  restorer.add_normals();
  restorer.add_changes(isovalue);
  restorer.apply_changes();
}

}  // namespace prefilter
