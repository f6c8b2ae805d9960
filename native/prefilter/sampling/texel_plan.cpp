#include "prefilter/sampling/texel_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace prefilter {
namespace {

FoldedPlace place_of_symmetry(int symmetry) {
  return {0.0, 0.0, (symmetry & 1) != 0, (symmetry & 2) != 0, (symmetry & 4) != 0};
}

/// The cells along an axis between which no offset from `least` to `most` leaves a level that has
/// `size` texels where there are `cells` of them.
void narrow(double size, double cells, int texels_of_cell, int least, int most, double& low,
            double& high) {
  const double ratio = size / cells;
  // A cell's low corner is rounded from somewhere within a texel of cell * ratio; where levels nest
  // it is that.
  const double slack = ratio == texels_of_cell ? 0.0 : std::abs(ratio - texels_of_cell) + 0.5;
  low = std::max(low, std::ceil((slack - least) / ratio));
  high = std::min(high, std::floor((size - 1 - most - slack) / ratio));
}

}  // namespace

TexelPlan::TexelPlan(const Pyramid& pyramid, const SamplingTable& table)
    : shape_(table.shape), padded_((table.shape.texels + 3) / 4 * 4) {
  const float unit = pyramid.bytes ? 1.0F / 255.0F : 1.0F;
  for (int levels = 1; levels <= 3; ++levels) {
    plan_section(table.section(levels), unit, sections_[levels - 1]);
  }
  for (int level = 0; level < static_cast<int>(pyramid.levels.size()); ++level) {
    cells_.push_back(plan_cells(pyramid, table, level));
  }
}

void TexelPlan::plan_section(const TableSection& section, float unit, SectionPlan& plan) const {
  const int texels = shape_.texels;
  const int terms = shape_.terms();
  const int subdomains = section.slices * shape_.subdomains_of_slice();
  plan.weights.resize(static_cast<std::size_t>(subdomains) * terms * padded_ / 4);
  plan.finer.resize(static_cast<std::size_t>(subdomains) * padded_);
  for (int subdomain = 0; subdomain < subdomains; ++subdomain) {
    for (int i = 0; i < texels; ++i) {
      const int from = subdomain * texels + i;
      plan.finer[subdomain * padded_ + i] = static_cast<std::uint8_t>(section.texels[from].finer);
      for (int term = 0; term < terms; ++term) {
        const int to = (subdomain * terms + term) * padded_ + i;
        plan.weights[to / 4][to % 4] =
            static_cast<float>(section.coefficients[from * terms + term]) * unit;
      }
    }
  }
}

PlannedCells TexelPlan::plan_cells(const Pyramid& pyramid, const SamplingTable& table, int level) {
  PlannedCells cells;
  cells.available = std::min(level + 1, 3);
  const TableSection& section = table.section(cells.available);
  const SectionPlan& plan = sections_[cells.available - 1];
  cells.weights = reinterpret_cast<const float*>(plan.weights.data());
  cells.finer = plan.finer.data();
  const auto texel_size = static_cast<double>(pyramid.texel_size());
  for (int finer = 0; finer < 3; ++finer) {
    const PyramidLevel& texels = pyramid.levels[level - std::min(finer, cells.available - 1)];
    cells.sizes[finer] =
        Pair{static_cast<double>(texels.width), static_cast<double>(texels.height)};
    cells.pitches[finer] = Pair{texel_size, texel_size * texels.width};
    cells.texels[finer] = reinterpret_cast<std::uintptr_t>(texels.texels);
  }
  cells.nests = true;
  for (int finer = 1; finer < cells.available; ++finer) {
    for (int axis = 0; axis < 2; ++axis) {
      cells.nests &= cells.sizes[finer][axis] == cells.sizes[0][axis] * (1 << finer);
    }
  }

  std::array<std::array<int, 2>, 3> least{}, most{};
  std::vector<std::int32_t>& offsets = offsets_.emplace_back();
  const int subdomains = section.slices * shape_.subdomains_of_slice();
  offsets.resize(static_cast<std::size_t>(subdomains) * kSymmetries * padded_);
  double farthest = 0.0;
  for (int i = 0; i < subdomains * kSymmetries; ++i) {
    const FoldedPlace place = place_of_symmetry(i % kSymmetries);
    for (int j = 0; j < shape_.texels; ++j) {
      const TexelOffset texel = unfold(section.texels[i / kSymmetries * shape_.texels + j], place);
      const std::array<int, 2> found{texel.x, texel.y};
      for (int axis = 0; axis < 2; ++axis) {
        least[texel.finer][axis] = std::min(least[texel.finer][axis], found[axis]);
        most[texel.finer][axis] = std::max(most[texel.finer][axis], found[axis]);
      }
      const double offset =
          cells.pitches[texel.finer][0] * texel.x + cells.pitches[texel.finer][1] * texel.y;
      farthest = std::max(farthest, std::abs(offset));
      // Where it is too far, no cell is given out as one that may read it.
      offsets[i * padded_ + j] =
          std::abs(offset) < 0x1p31 ? static_cast<std::int32_t>(offset) : std::int32_t{0};
    }
  }
  cells.offsets = offsets.data();
  for (int axis = 0; axis < 2; ++axis) {
    double low = 0.0;
    double high = cells.sizes[0][axis] - 1;
    for (int finer = 0; finer < cells.available; ++finer) {
      narrow(cells.sizes[finer][axis], cells.sizes[0][axis], 1 << finer, least[finer][axis],
             most[finer][axis], low, high);
    }
    cells.low[axis] = low;
    cells.high[axis] = farthest < 0x1p31 ? high : -1.0;
  }
  return cells;
}

}  // namespace prefilter
