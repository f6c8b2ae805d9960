// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/plane_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "prefilter/base/geometry.h"
#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/wavelet/cell_polygon.h"

namespace prefilter {
namespace {

constexpr double kHalfDiagonal = 0.8661;    // sqrt(3) / 2, rounded up
constexpr double kMinPlaneCoherence = 0.2;  // least length of the mean normal

// A plane in coordinates in which the cell is the unit cube.
struct Plane {
  Vector3 normal;  // of length 1
  Vector3 point;
};

std::optional<Plane> plane_of(const Vector3& normal, const Vector3& position, double weight) {
  const double length = std::sqrt(dot(normal, normal));
  if (!(length > kMinPlaneCoherence * weight)) return std::nullopt;
  Plane plane;
  for (std::size_t a = 0; a < 3; ++a) {
    plane.normal[a] = normal[a] / length;
    plane.point[a] = position[a] / weight;
  }
  return plane;
}

Vector3 doubles(const std::array<float, 3>& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

std::optional<Plane> plane_of(const SampleCell& cell) {
  return plane_of(doubles(cell.normal), doubles(cell.position), static_cast<double>(cell.weight));
}

// Clips a plane to the unit cell; corners run counterclockwise around the normal.
CellPolygon cut_to_cell(const Plane& plane) {
  const Vector3& n = plane.normal;
  const Vector3 middle = {0.5, 0.5, 0.5};
  const double height = dot(plane.point - middle, n);
  CellPolygon polygon;
  if (std::abs(height) >= kHalfDiagonal) return polygon;
  const int least = std::abs(n[0]) < std::abs(n[1]) ? (std::abs(n[0]) < std::abs(n[2]) ? 0 : 2)
                                                    : (std::abs(n[1]) < std::abs(n[2]) ? 1 : 2);
  Vector3 axis{};
  axis[least] = 1.0;
  Vector3 u = cross(n, axis);
  const double length = std::sqrt(dot(u, u));
  for (double& x : u) x /= length;
  const Vector3 v = cross(n, u);
  constexpr std::array<std::array<double, 2>, 4> kCorners = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  for (const auto& [s, t] : kCorners) {
    Vector3 corner;
    for (std::size_t a = 0; a < 3; ++a) corner[a] = middle[a] + height * n[a] + s * u[a] + t * v[a];
    polygon.add(corner);
  }
  for (int a = 0; a < 3 && polygon.count > 0; ++a) clip_to_slab(a, 0.0, 1.0, &polygon);
  return polygon;
}

// Adds patches of planes to the flux of the cells that contain them.
struct PatchSink {
  const SplitCells& splits;
  PooledFlux* flux;

  // Adds a plane's patch in a cell of depth `k`, or in its octants where it is split. Only patches
  // of cells with samples constrain the function's value.
  void add(std::uint64_t place, int k, const Plane& plane, bool is_sampled) const {
    const CellPolygon polygon = cut_to_cell(plane);
    if (polygon.count >= 3) add_cut(place, k, plane, polygon, is_sampled);
  }

  void add_cut(std::uint64_t place, int k, const Plane& plane, const CellPolygon& polygon,
               bool is_sampled) const {
    if (splits.is_split(k, place)) {
      for (std::uint64_t o = 0; o < 8; ++o) {
        Plane within = plane;
        for (std::size_t a = 0; a < 3; ++a) {
          within.point[a] = 2.0 * plane.point[a] - static_cast<double>((o >> a) & 1U);
        }
        add(place << 3U | o, k + 1, within, is_sampled);
      }
      return;
    }
    CellFlux piece;
    piece.place = place;
    piece.flux = polygon_flux(polygon, {0.0, 0.0, 0.0});
    if (is_sampled) piece.sampled = sampled_area(polygon, piece.flux);
    (*flux)[static_cast<std::size_t>(k)].push_back(piece);
  }

 private:
  // Uses the mean of the corners as the position, which lies within the patch.
  static SampledArea sampled_area(const CellPolygon& polygon, const BoundaryFlux& flux) {
    SampledArea result;
    const double area = std::sqrt(dot(flux.area, flux.area));
    result.area = static_cast<float>(area);
    for (std::size_t a = 0; a < 3; ++a) {
      double sum = 0.0;
      for (int i = 0; i < polygon.count; ++i) sum += polygon.corners[i][a];
      result.moment[a] = static_cast<float>(area * sum / polygon.count);
    }
    return result;
  }
};

// A plane that leaves its cell through a face into a cell without samples.
struct PlaneExit {
  CellKey key;  // of the cell entered
  const SampleCell* from;
  int face;
};

// Sums for a cell without samples, extrapolated from the planes that enter it.
struct ExtrapolatedPlane {
  CellKey key = 0;
  Vector3 normal{};
  Vector3 position{};
  double weight = 0.0;
};

// Finds the neighbors of cells; queries must come in row-major order.
class CellNeighbors {
 public:
  explicit CellNeighbors(const std::vector<CellKey>& keys) : keys_(keys) {}

  bool has(std::size_t face, CellKey key) {
    std::size_t& cursor = cursors_[face];
    while (cursor < keys_.size() && keys_[cursor] < key) ++cursor;
    return cursor < keys_.size() && keys_[cursor] == key;
  }

 private:
  const std::vector<CellKey>& keys_;
  std::array<std::size_t, 6> cursors_{};
};

// The cells into which planes may be extrapolated.
struct CellRange {
  int side;  // of the root, in cells
  int low;   // lowest height
  int high;  // end of the heights

  bool holds(const CellPosition& at, int axis) const {
    return at[axis] >= 0 && at[axis] < side && at[2] >= low && at[2] < high;
  }
};

// Adds the exits of a cell's plane into adjacent cells without samples.
void add_exits(const SampleCell& cell, const CellPolygon& polygon, const CellRange& range,
               CellNeighbors* neighbors, std::vector<PlaneExit>* exits) {
  const CellPosition at = cell_position(cell.key);
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const bool is_high = (face & 1) != 0;
    if (is_high ? polygon.highest(axis) < 1.0 : polygon.lowest(axis) > 0.0) continue;
    CellPosition next = at;
    next[axis] += is_high ? 1 : -1;
    if (!range.holds(next, axis)) continue;
    if (neighbors->has(static_cast<std::size_t>(face), cell_key(next))) continue;
    exits->push_back({cell_key(next), &cell, face});
  }
}

// Sums the exits per cell entered, in order of these cells.
std::vector<ExtrapolatedPlane> sum_exits(std::vector<PlaneExit> exits) {
  std::stable_sort(exits.begin(), exits.end(),
                   [](const PlaneExit& a, const PlaneExit& b) { return a.key < b.key; });
  std::vector<ExtrapolatedPlane> guesses;
  for (const PlaneExit& each : exits) {
    if (guesses.empty() || guesses.back().key != each.key) guesses.push_back({each.key});
    const SampleCell& cell = *each.from;
    std::array<float, 3> position = cell.position;
    position[each.face / 2] += (each.face & 1) != 0 ? -cell.weight : cell.weight;
    ExtrapolatedPlane& sum = guesses.back();
    sum.weight += static_cast<double>(cell.weight);
    sum.normal = sum.normal + doubles(cell.normal);
    sum.position = sum.position + doubles(position);
  }
  return guesses;
}

// Calls visit(level, i) for the cells of a slab and of the adjacent layers, in row-major order.
template <typename Visit>
void for_cells_and_layers(const SampleLevel* below, const SampleLevel& level,
                          const SampleLevel* above, const CellRange& range, const Visit& visit) {
  const auto height = [](const SampleLevel& of, std::size_t i) {
    return cell_position(of.samples.cells[i].key)[2];
  };
  for (std::size_t i = 0; below != nullptr && i < below->size(); ++i) {
    if (height(*below, i) == range.low - 1) visit(*below, i);
  }
  for (std::size_t i = 0; i < level.size(); ++i) visit(level, i);
  for (std::size_t i = 0; above != nullptr && i < above->size(); ++i) {
    if (height(*above, i) > range.high) break;
    visit(*above, i);
  }
}

// Whether a cell without samples is covered by leaves of another size: by a coarser one that
// contains it, or by finer ones next to it.
bool is_covered_by_other_depths(CellKey key, const SampleLevel* coarser,
                                const std::vector<CellKey>& split) {
  const CellPosition at = cell_position(key);
  if (coarser != nullptr) {
    const std::vector<SampleCell>& cells = coarser->samples.cells;
    const CellKey parent = cell_key({at[0] / 2, at[1] / 2, at[2] / 2});
    const auto it =
        std::lower_bound(cells.begin(), cells.end(), parent,
                         [](const SampleCell& cell, CellKey sought) { return cell.key < sought; });
    if (it != cells.end() && it->key == parent &&
        coarser->is_split[static_cast<std::size_t>(it - cells.begin())] == 0) {
      return true;
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    for (const int step : {-1, 1}) {
      CellPosition next = at;
      next[a] += step;
      if (std::binary_search(split.begin(), split.end(), cell_key(next))) return true;
    }
  }
  return false;
}

}  // namespace

void add_patches(const PatchLevels& levels, int depth, int low, int high, const SplitCells& splits,
                 PooledFlux* flux) {
  const auto& [below, own, above, coarser] = levels;
  const SampleLevel& level = *own;
  const PatchSink sink = {splits, flux};
  const std::vector<CellKey> keys = with_layers(below, level, above).keys;
  CellNeighbors neighbors(keys);
  std::vector<PlaneExit> exits;
  const CellRange range = {1 << depth, low, high};
  std::vector<CellKey> split;
  const auto visit = [&](const SampleLevel& from, std::size_t i) {
    if (from.is_split[i] != 0) split.push_back(from.samples.cells[i].key);
    if (from.is_leaf[i] == 0) return;
    const SampleCell& cell = from.samples.cells[i];
    const std::optional<Plane> plane = plane_of(cell);
    if (!plane) return;
    const CellPolygon polygon = cut_to_cell(*plane);
    if (polygon.count < 3) return;
    if (&from == &level) {
      sink.add_cut(morton_index(cell_position(cell.key)), depth, *plane, polygon, true);
    }
    add_exits(cell, polygon, range, &neighbors, &exits);
  };
  for_cells_and_layers(below, level, above, range, visit);
  for (const ExtrapolatedPlane& guess : sum_exits(std::move(exits))) {
    if (is_covered_by_other_depths(guess.key, coarser, split)) continue;
    const std::optional<Plane> plane = plane_of(guess.normal, guess.position, guess.weight);
    if (plane) sink.add(morton_index(cell_position(guess.key)), depth, *plane, false);
  }
}

}  // namespace prefilter
