// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/sample_slab.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "prefilter/base/elementary.h"
#include "prefilter/base/geometry.h"
#include "prefilter/base/radix_sort.h"
#include "prefilter/points/normals/local_plane.h"

namespace prefilter {
namespace {

constexpr int kIndexBits = 64 - kKeyBits;
constexpr int kAreaDepthsUp = 2;  // areas are averaged over cells so much coarser
// Cells at this depth always count, so that every sample has a leaf.
constexpr int kCoarsestLeaf = 2;
// Approximate number of cells, among the 27 around one, that a plane through its center crosses.
constexpr double kCrossedCellsAround27 = 9.0;
// Criteria for a surface: occupied cells among the 27 around one, and the RMS distance of their
// mean samples from a plane, in cells. For points scattered in space the latter is about 0.8.
constexpr std::size_t kMinSurfaceCells = 6;
constexpr double kMaxRmsOffPlane = 0.25;
// Minimum difference in depth between the cell of a stray sample and the samples around it.
constexpr int kStrayDepths = 3;
// Samples per crossed cell.
constexpr double kMinSamplesPerCell = 0.75;
// Samples in the 27 cells around one whose octants hold kMinSamplesPerCell each.
constexpr double kMinSamplesAround27 = 4.0 * kCrossedCellsAround27 * kMinSamplesPerCell;
// Samples per crossed cell from which it can be refined twice: slightly less than 8, so that
// rounding does not decide.
constexpr double kMinSamplesOfCell = 7.99;
// Samples in the 27 cells around one from which a lone sample in it is a stray.
constexpr double kStraySamplesAround =
    6.0 * kCrossedCellsAround27 * (1 << (2 * (kStrayDepths - 1)));

SampleLevel coarser(SampleLevel* level, std::size_t attribute_count) {
  const std::vector<SampleCell>& cells = level->samples.cells;
  std::vector<std::uint64_t> order;
  order.reserve(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellPosition at = cell_position(cells[i].key);
    order.push_back((cell_key({at[0] / 2, at[1] / 2, at[2] / 2}) << kIndexBits) | i);
  }
  std::vector<std::uint64_t> other;
  radix_sort(&order, kIndexBits, 64, &other);
  other = {};
  std::size_t count = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || order[i] >> kIndexBits != order[i - 1] >> kIndexBits) ++count;
  }
  SampleLevel result;
  result.samples.cells.reserve(count);
  result.samples.attributes.reserve(count * attribute_count);
  level->parents.resize(cells.size());
  for (const std::uint64_t entry : order) {
    const auto i = static_cast<std::size_t>(entry & ((std::uint64_t{1} << kIndexBits) - 1));
    const SampleCell moved = in_parent(cells[i]);
    SampleCells& parents = result.samples;
    if (parents.cells.empty() || parents.cells.back().key != moved.key) {
      parents.cells.emplace_back();
      parents.cells.back().key = moved.key;
      parents.attributes.resize(parents.attributes.size() + attribute_count);
    }
    parents.cells.back().add(moved);
    float* const sums = parents.attributes.data() + parents.attributes.size() - attribute_count;
    for (std::size_t k = 0; k < attribute_count; ++k) {
      sums[k] += level->samples.attributes[i * attribute_count + k];
    }
    level->parents[i] = static_cast<std::uint32_t>(parents.cells.size() - 1);
  }
  return result;
}

// Whether the mean samples of cells lie near a plane.
bool are_flat(std::span<const Vector3> means) {
  if (means.size() < kMinSurfaceCells) return false;
  const double share = 1.0 / static_cast<double>(means.size());
  Vector3 middle{};
  for (const Vector3& mean : means) middle = middle + share * mean;
  SymmetricMatrix covariance;
  for (const Vector3& mean : means) covariance.add_square(share, mean - middle);
  const Vector3 normal = least_eigenvector(covariance);
  double squared = 0.0;
  for (const Vector3& mean : means) {
    const double off = dot(mean - middle, normal);
    squared += off * off;
  }
  // Any three points lie on a plane.
  return squared <= kMaxRmsOffPlane * kMaxRmsOffPlane * static_cast<double>(means.size() - 3);
}

Vector3 mean_sample(const SampleCell& cell) {
  const CellPosition at = cell_position(cell.key);
  Vector3 mean;
  for (std::size_t a = 0; a < 3; ++a) {
    mean[a] = at[a] + static_cast<double>(cell.position[a]) / static_cast<double>(cell.weight);
  }
  return mean;
}

// Counts the occupied neighbors of each cell, and marks thinly sampled cells that lie on no
// surface. Because keys are in row-major order, the nine rows around consecutive cells are as well,
// so one cursor per row suffices for a single pass.
void mark_crossed_cells(const CellLayers& cells, double mean_weight, SampleLevel* level) {
  const std::vector<CellKey>& keys = cells.keys;
  std::array<CellKey, 9> rows;
  for (std::size_t r = 0; r < 9; ++r) {
    rows[r] = ((CellKey{r / 3} << kRowShift) + r % 3) << kRowShift;
  }
  constexpr CellKey kBack = ((CellKey{1} << kRowShift) + 1) << kRowShift;
  std::array<std::size_t, 9> cursors{};
  level->occupied.resize(level->size());
  level->around.resize(level->size());
  level->is_scattered.resize(level->size());
  std::array<const SampleCell*, 27> near;
  std::vector<Vector3> means;
  for (std::size_t i = 0; i < level->size(); ++i) {
    const CellKey key = level->samples.cells[i].key;
    int last_near = -1;  // excludes the cell itself
    float around = 0.0F;
    means.clear();
    for (std::size_t r = 0; r < 9; ++r) {
      const CellKey middle = key + rows[r] - kBack;
      std::size_t& cursor = cursors[r];
      while (cursor < keys.size() && keys[cursor] + 1 < middle) ++cursor;
      for (std::size_t j = cursor; j < keys.size() && keys[j] <= middle + 1; ++j) {
        ++last_near;
        around += cells.cells[j]->weight;
        near[static_cast<std::size_t>(last_near)] = cells.cells[j];
      }
    }
    level->around[i] = around;
    level->occupied[i] = static_cast<std::uint8_t>(last_near + 1);
    level->is_scattered[i] = 0;
    if (static_cast<double>(around) >= kStraySamplesAround * mean_weight) continue;
    for (int n = 0; n <= last_near; ++n)
      means.push_back(mean_sample(*near[static_cast<std::size_t>(n)]));
    level->is_scattered[i] = are_flat(means) ? 0 : 1;
  }
}

// Share of the crossed cells that contain samples, from the mean number of samples per occupied
// cell. Suppose rho samples per crossed cell, and cells' shares of the surface spread evenly
// between 0 and twice their mean; then it is 1 - (1 - exp(-2 rho)) / (2 rho).
double share_hit(double samples_per_cell) {
  constexpr double kMinShare = 0.3;  // lower limit of the result
  double rho = samples_per_cell;
  for (int i = 0; i < 30; ++i) {
    const double share = 1.0 + elementary::expm1(-2.0 * rho) / (2.0 * rho);
    if (share < kMinShare) return kMinShare;
    rho = samples_per_cell * share;
  }
  return rho / samples_per_cell;
}

// Expected area of the surface in a cell, in squared cell sides, averaged over all positions of a
// plane with the cell's normal.
double area_in(const SampleCell& cell) {
  Vector3 n;
  for (std::size_t a = 0; a < 3; ++a) n[a] = static_cast<double>(cell.normal[a]);
  const double sum = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
  const double length = std::sqrt(dot(n, n));
  // Normals cancel each other: use the mean over all directions.
  if (!(length > 0.2 * static_cast<double>(cell.weight))) return 1.0 / 1.5;
  return length / sum;
}

// Whether the occupied cells around the ancestor two depths up hold enough samples each, which thin
// parts with few occupied cells need. `parent` is a cell of the depth above.
bool is_crowded(const SampleSlab& slab, int k, std::uint32_t parent, const CloudLeaves& cloud) {
  if (k - 2 < slab.top) return false;
  const std::uint32_t i = slab.at(k - 1).parents[parent];
  const SampleLevel& above = slab.at(k - 2);
  return static_cast<double>(above.around[i]) >=
         kMinSamplesOfCell * above.occupied[i] * cloud.mean_weight;
}

// Samples count at this depth where the surface seems to cross their cell and there are enough
// samples for its size, counted around the ancestor two depths up so that sizes do not fluctuate.
void find_leaves_of_level(const CloudLeaves& cloud, int finest, int k, SampleSlab* slab) {
  const double enough = kMinSamplesAround27 * cloud.mean_weight;
  const double isolated = kStraySamplesAround * cloud.mean_weight;
  SampleLevel& level = slab->at(k);
  const SampleLevel& above = slab->at(k - 1);
  level.leaf.resize(level.size());
  for (std::size_t i = 0; i < level.size(); ++i) {
    const std::uint32_t parent = level.parents[i];
    const auto around = static_cast<double>(above.around[parent]);
    const double wide =
        k - 2 >= slab->top
            ? static_cast<double>(slab->at(k - 2).around[above.parents[parent]]) / 4.0
            : around;
    const bool counts =
        k <= kCoarsestLeaf || (level.is_crossed(i) && around >= enough / 4.0 &&
                               (wide >= enough || is_crowded(*slab, k, parent, cloud)));
    const bool is_stray =
        above.leaf[parent] == k - 1 && around >= isolated && finest - (k - 1) >= kStrayDepths;
    if (counts) {
      const bool is_outlier = k < cloud.least_leaf && level.is_scattered[i] != 0;
      level.leaf[i] = static_cast<std::int8_t>(is_outlier ? -1 : k);
    } else {
      level.leaf[i] = is_stray ? std::int8_t{-1} : above.leaf[parent];
    }
  }
}

struct Extent {
  double area = 0.0;
  double weight = 0.0;
  double cells = 0.0;
};

}  // namespace

SampleSlab make_sample_slab(SampleCells finest, int depth, int top, std::size_t attribute_count) {
  SampleSlab slab;
  slab.top = top;
  slab.levels.resize(static_cast<std::size_t>(depth - top + 1));
  slab.at(depth).samples = std::move(finest);
  for (int k = depth; k > top; --k) slab.at(k - 1) = coarser(&slab.at(k), attribute_count);
  return slab;
}

CellLayers with_layers(const SampleLevel* below, const SampleLevel& level,
                       const SampleLevel* above) {
  CellLayers layers;
  if (below != nullptr && below->size() > 0) {
    const std::vector<SampleCell>& cells = below->samples.cells;
    const int last = cell_position(cells.back().key)[2];
    auto first = cells.end();
    while (first != cells.begin() && cell_position(std::prev(first)->key)[2] == last) --first;
    for (; first != cells.end(); ++first) layers.add(*first);
  }
  for (const SampleCell& cell : level.samples.cells) layers.add(cell);
  if (above != nullptr && above->size() > 0) {
    const int first = cell_position(above->samples.cells.front().key)[2];
    for (const SampleCell& cell : above->samples.cells) {
      if (cell_position(cell.key)[2] != first) break;
      layers.add(cell);
    }
  }
  return layers;
}

void find_crossed_cells(const SampleSlab* below, const SampleSlab* above, double mean_weight,
                        SampleSlab* slab) {
  for (int k = slab->top; k <= slab->depth(); ++k) {
    mark_crossed_cells(with_layers(below == nullptr ? nullptr : &below->at(k), slab->at(k),
                                   above == nullptr ? nullptr : &above->at(k)),
                       mean_weight, &slab->at(k));
  }
}

void find_split(SampleSlab* slab) {
  for (int k = slab->depth(); k > slab->top; --k) {
    const SampleLevel& level = slab->at(k);
    SampleLevel& above = slab->at(k - 1);
    above.is_split.assign(above.size(), 0);
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (level.leaf[i] == k || level.is_split[i] != 0) above.is_split[level.parents[i]] = 1;
    }
  }
  for (int k = slab->top; k <= slab->depth(); ++k) {
    SampleLevel& level = slab->at(k);
    level.is_leaf.assign(level.size(), 0);
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (level.is_split[i] != 0 || level.leaf[i] < 0) continue;
      const bool is_of_split = k > slab->top && slab->at(k - 1).is_split[level.parents[i]] != 0;
      if (level.leaf[i] == k || is_of_split) level.is_leaf[i] = 1;
    }
  }
}

double weight_of_outliers(const SampleLevel& finest) {
  double weight = 0.0;
  for (std::size_t i = 0; i < finest.size(); ++i) {
    if (finest.leaf[i] < 0) weight += static_cast<double>(finest.samples.cells[i].weight);
  }
  return weight;
}

void find_leaves(const CloudLeaves& cloud, int finest, SampleSlab* slab) {
  for (int k = slab->top; k <= slab->depth(); ++k) {
    SampleLevel& level = slab->at(k);
    if (k > slab->top) find_leaves_of_level(cloud, finest, k, slab);
    const int steps = std::min(kAreaDepthsUp, k - slab->top);
    std::vector<std::uint32_t> ancestors(level.size());
    for (std::size_t i = 0; i < level.size(); ++i) {
      std::uint32_t at = static_cast<std::uint32_t>(i);
      for (int s = 0; s < steps; ++s) at = slab->at(k - s).parents[at];
      ancestors[i] = at;
    }
    std::vector<Extent> extents(slab->at(k - steps).size());
    for (std::size_t i = 0; i < level.size(); ++i) {
      Extent& extent = extents[ancestors[i]];
      extent.area += area_in(level.samples.cells[i]);
      extent.weight += static_cast<double>(level.samples.cells[i].weight);
      extent.cells += 1.0;
    }
    const double side = std::ldexp(1.0, finest - k);
    std::vector<float> unit_areas(extents.size());
    for (std::size_t i = 0; i < extents.size(); ++i) {
      const Extent& e = extents[i];
      const double share = share_hit(e.weight / (e.cells * cloud.mean_weight));
      unit_areas[i] = static_cast<float>(e.area * side * side / (share * e.weight));
    }
    level.unit_area.resize(level.size());
    for (std::size_t i = 0; i < level.size(); ++i) level.unit_area[i] = unit_areas[ancestors[i]];
  }
  // Free the intermediate results.
  for (SampleLevel& level : slab->levels) {
    level.occupied = {};
    level.around = {};
    level.is_scattered = {};
  }
  slab->at(slab->depth()).is_split.assign(slab->at(slab->depth()).size(), 0);
  find_split(slab);
}

}  // namespace prefilter
