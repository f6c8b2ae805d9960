// SPDX-License-Identifier: GPL-3.0-or-later

// Section 6.2: unfolds the symmetries of a cell, and converts texels to offsets from the cell's
// corner.
#include "prefilter/sampling/texel_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace prefilter {
namespace {

FoldedPlace place_of_symmetry(int symmetry) {
  return {0.0, 0.0, (symmetry & 1) != 0, (symmetry & 2) != 0, (symmetry & 4) != 0};
}

/// Narrows [low, high] to the cells along an axis whose offsets from `least` to `most` stay inside
/// a level of `size` texels. The image has an extent of `extent` texels and `cells` cells.
void narrow(int size, double extent, double cells, int texels_of_cell, int least, int most,
            double& low, double& high) {
  const double ratio = extent / cells;
  // The low corner of a cell is rounded from within a texel of cell * ratio, and exact if levels
  // nest.
  const double slack = ratio == texels_of_cell ? 0.0 : std::abs(ratio - texels_of_cell) + 0.5;
  low = std::max(low, std::ceil((slack - least) / ratio));
  high = std::min(high, std::floor((size - 1 - most - slack) / ratio));
}

}  // namespace

TexelPlan::TexelPlan(const Pyramid& pyramid, const SamplingTable& table)
    : shape_(table.shape), padded_((table.shape.texels + 3) / 4 * 4) {
  const float unit = pyramid.bytes ? 1.0F / 255.0F : 1.0F;
  const int levels = static_cast<int>(pyramid.levels.size());
  for (int available = 1; available <= std::min(levels, 3); ++available) {
    plan_section(table.section(available), unit, sections_[available - 1]);
  }
  for (int level = 0; level < levels; ++level) cells_.push_back(plan_cells(pyramid, level));
  for (const PyramidLevel& level : pyramid.levels) {
    bytes_ += pyramid.texel_size() * static_cast<std::size_t>(level.width) *
              static_cast<std::size_t>(level.height);
  }
}

void TexelPlan::plan_section(const TableSection& section, float unit, Section& plan) const {
  const int texels = shape_.texels;
  const int terms = shape_.terms();
  const int subdomains = section.slices * shape_.subdomains_of_slice();
  plan.weights.resize(static_cast<std::size_t>(subdomains) * terms * padded_ / 4);
  plan.finer.resize(static_cast<std::size_t>(subdomains) * padded_);
  plan.unfolded.resize(plan.finer.size() * kSymmetries);
  for (int subdomain = 0; subdomain < subdomains; ++subdomain) {
    for (int i = 0; i < texels; ++i) {
      const int from = subdomain * texels + i;
      const TexelOffset& texel = section.texels[from];
      plan.finer[subdomain * padded_ + i] = static_cast<std::uint8_t>(texel.finer);
      for (int term = 0; term < terms; ++term) {
        const int to = (subdomain * terms + term) * padded_ + i;
        plan.weights[to / 4][to % 4] =
            static_cast<float>(section.coefficients[from * terms + term]) * unit;
      }
      std::array<int, 2>& least = plan.least[texel.finer];
      std::array<int, 2>& most = plan.most[texel.finer];
      for (int symmetry = 0; symmetry < kSymmetries; ++symmetry) {
        const TexelOffset unfolded = unfold(texel, place_of_symmetry(symmetry));
        plan.unfolded[(subdomain * kSymmetries + symmetry) * padded_ + i] = unfolded;
        least = {std::min(least[0], unfolded.x), std::min(least[1], unfolded.y)};
        most = {std::max(most[0], unfolded.x), std::max(most[1], unfolded.y)};
      }
    }
  }
}

void TexelPlan::plan_distances(PlannedCells& cells, const Section& section) {
  std::vector<std::int32_t>& distances = distances_.emplace_back();
  distances.reserve(section.unfolded.size());
  for (const TexelOffset& texel : section.unfolded) {
    const Pair pitch = cells.pitches[texel.finer];
    const double distance = pitch[0] * texel.x + pitch[1] * texel.y;
    const bool fits = std::abs(distance) < 0x1p31;
    // Marks all cells as reading outside.
    if (!fits) cells.high = Pair{-1.0, -1.0};
    distances.push_back(fits ? static_cast<std::int32_t>(distance) : 0);
  }
  cells.distances = distances.data();
}

PlannedCells TexelPlan::plan_cells(const Pyramid& pyramid, int level) {
  PlannedCells cells;
  cells.available = std::min(level + 1, 3);
  const Section& section = sections_[cells.available - 1];
  cells.weights = reinterpret_cast<const float*>(section.weights.data());
  cells.finer = section.finer.data();
  cells.unfolded = section.unfolded.data();
  const auto texel_size = static_cast<double>(pyramid.texel_size());
  for (int finer = 0; finer < 3; ++finer) {
    const PyramidLevel& texels = pyramid.levels[level - std::min(finer, cells.available - 1)];
    cells.extents[finer] = Pair{texels.columns, texels.rows};
    cells.pitches[finer] = Pair{texel_size, texel_size * texels.width};
    cells.texels[finer] = reinterpret_cast<std::uintptr_t>(texels.texels);
  }
  cells.nests = true;
  for (int axis = 0; axis < 2; ++axis) {
    double low = 0.0;
    const auto size = [&](int finer) {
      const PyramidLevel& texels = pyramid.levels[level - finer];
      return axis == 0 ? texels.width : texels.height;
    };
    double high = size(0) - 1;
    for (int finer = 0; finer < cells.available; ++finer) {
      const double extent = cells.extents[finer][axis];
      const double image_cells = cells.extents[0][axis];
      cells.nests &= extent == image_cells * (1 << finer);
      narrow(size(finer), extent, image_cells, 1 << finer, section.least[finer][axis],
             section.most[finer][axis], low, high);
    }
    cells.low[axis] = low;
    cells.high[axis] = high;
  }
  plan_distances(cells, section);
  return cells;
}

}  // namespace prefilter
