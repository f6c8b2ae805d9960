// SPDX-License-Identifier: GPL-3.0-or-later

// Dilates the surface cells by half of the gap, flood-fills the outside and the remaining regions,
// and grows these back simultaneously by the same amount, so that they meet in the middle of gaps.
#include "prefilter/voxels/solid/reach.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/parallel.h"
#include "prefilter/wavelet/cell_polygon.h"

namespace prefilter {
namespace {

constexpr double kMostCells = 256.0;  // along the longest axis
constexpr std::int64_t kReachRowsPerTask = 1 << 10;

// Index of the first cell with a value in [begin, end), or `end`.
std::size_t first_of(int value, const std::vector<std::uint8_t>& cells, std::size_t begin,
                     std::size_t end) {
  const void* match = std::memchr(cells.data() + begin, value, end - begin);
  if (match == nullptr) return end;
  return static_cast<std::size_t>(static_cast<const std::uint8_t*>(match) - cells.data());
}

// Dilates the set cells by `radius` along each axis.
std::vector<std::uint8_t> widened(std::vector<std::uint8_t> cells, const std::array<int, 3>& size,
                                  int radius, int threads) {
  std::vector<std::uint8_t> other(cells.size());
  const auto rows = static_cast<std::size_t>(size[1]);
  const auto row = static_cast<std::size_t>(size[2]);
  const auto plane = rows * row;
  const auto include = [](const std::uint8_t* from, std::size_t count, std::uint8_t* to) {
    for (std::size_t i = 0; i < count; ++i) to[i] |= from[i];
  };
  // One pass per axis, over contiguous strips.
  const auto pass = [&](std::size_t axis, std::int64_t x) {
    const std::uint8_t* const from = cells.data();
    const std::size_t begin = static_cast<std::size_t>(x) * plane;
    std::copy_n(from + begin, plane, other.data() + begin);
    for (int k = 1; k <= radius; ++k) {
      const auto shift = static_cast<std::size_t>(k);
      if (axis == 0) {
        if (x >= k) include(from + begin - shift * plane, plane, &other[begin]);
        if (x + k < size[0]) include(from + begin + shift * plane, plane, &other[begin]);
      } else if (axis == 1 && shift < rows) {
        const std::size_t count = (rows - shift) * row;
        include(from + begin, count, &other[begin + shift * row]);
        include(from + begin + shift * row, count, &other[begin]);
      } else if (axis == 2 && shift < row) {
        for (std::size_t y = 0; y < rows; ++y) {
          const std::size_t first = begin + y * row;
          include(from + first, row - shift, &other[first + shift]);
          include(from + first + shift, row - shift, &other[first]);
        }
      }
    }
  };
  for (std::size_t axis = 0; axis < 3 && radius > 0; ++axis) {
    parallel_for(size[0], Run(threads), [&](std::int64_t x) { pass(axis, x); });
    cells.swap(other);
  }
  return cells;
}

}  // namespace

template <typename Visit>
void ReachGrid::for_neighbors(std::size_t cell, const Visit& visit) const {
  const auto ny = static_cast<std::size_t>(size_[1]);
  const auto nz = static_cast<std::size_t>(size_[2]);
  const std::size_t z = cell % nz;
  const std::size_t y = cell / nz % ny;
  const std::size_t x = cell / (ny * nz);
  if (z > 0) visit(cell - 1);
  if (z + 1 < nz) visit(cell + 1);
  if (y > 0) visit(cell - nz);
  if (y + 1 < ny) visit(cell + nz);
  if (x > 0) visit(cell - ny * nz);
  if (x + 1 < static_cast<std::size_t>(size_[0])) visit(cell + ny * nz);
}

ReachGrid::ReachGrid(const MeshView<std::int32_t>& mesh, double cell, double gap, const Run& run) {
  Box box = kEmptyBox;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Vector3& corner : mesh.corners(t)) box.include(corner);
  }
  const double longest = std::max({box.size(0), box.size(1), box.size(2)});
  cell_ = std::max(cell, longest / kMostCells);
  // A gap of one cell is closed anyway, as triangles cross its cells.
  const int radius = std::max(0, static_cast<int>(std::ceil((gap / cell_ - 1.0) / 2.0)));
  const int margin = radius + 2;
  for (int a = 0; a < 3; ++a) {
    size_[a] = static_cast<int>(std::ceil(box.size(a) / cell_)) + 1 + 2 * margin;
    origin_[a] = box.low[a] + box.size(a) / 2.0 - size_[a] * cell_ / 2.0;
  }
  labels_.assign(index(size_[0] - 1, size_[1] - 1, size_[2] - 1) + 1, kUnset);
  mark_surface(mesh, run.part(0.0, 0.5));

  std::vector<std::uint8_t> is_surface(labels_.size());
  for (std::size_t i = 0; i < labels_.size(); ++i) is_surface[i] = labels_[i] == kSurface ? 1 : 0;
  std::vector<std::uint8_t> is_free = widened(std::move(is_surface), size_, radius, run.threads());
  for (std::uint8_t& flag : is_free) flag ^= 1U;
  run.report(0.6);
  flood(0, kOutside, &is_free);
  run.report(0.8);
  for (std::size_t i = 0; (i = first_of(1, is_free, i, is_free.size())) < is_free.size();) {
    flood(i, region_end_, &is_free);
    if (region_end_ < kUnset - 1) ++region_end_;
  }
  grow(2 * radius);
  for (Label& label : labels_) {
    if (label == kUnset) label = kPocket;
  }
  stack_ = {};
  run.report(1.0);
}

void ReachGrid::mark_surface(const MeshView<std::int32_t>& mesh, const Run& run) {
  const CellBox all = {{0, 0, 0}, size_};
  parallel_ranges(static_cast<std::int64_t>(mesh.triangles.size()), kReachRowsPerTask, run,
                  [&](std::int64_t begin, std::int64_t end) {
                    for (std::int64_t t = begin; t < end; ++t) {
                      CellPolygon polygon;
                      for (const Vector3& corner : mesh.corners(static_cast<std::size_t>(t))) {
                        Vector3 at;
                        for (std::size_t a = 0; a < 3; ++a)
                          at[a] = (corner[a] - origin_[a]) / cell_;
                        polygon.add(at);
                      }
                      cut_polygon(polygon, all,
                                  [&](const std::array<int, 3>& cell, const CellPolygon&) {
                                    std::atomic_ref(labels_[index(cell[0], cell[1], cell[2])])
                                        .store(kSurface, std::memory_order_relaxed);
                                  });
                    }
                  });
}

void ReachGrid::flood(std::size_t seed, Label label, std::vector<std::uint8_t>* is_free) {
  std::vector<std::uint8_t>& free = *is_free;
  const auto rows = static_cast<std::size_t>(size_[1]);
  const auto row = static_cast<std::size_t>(size_[2]);
  const std::size_t plane = rows * row;
  // Fills runs along z, and pushes one cell of each adjacent run onto the stack.
  stack_.assign(1, seed);
  while (!stack_.empty()) {
    std::size_t begin = stack_.back();
    stack_.pop_back();
    if (free[begin] == 0) continue;
    const std::size_t first = begin / row * row;
    const std::size_t end = first_of(0, free, begin, first + row);
    while (begin > first && free[begin - 1] != 0) --begin;
    std::fill_n(labels_.begin() + static_cast<std::ptrdiff_t>(begin), end - begin, label);
    std::fill_n(free.begin() + static_cast<std::ptrdiff_t>(begin), end - begin, std::uint8_t{0});
    const std::size_t y = first / row % rows;
    const std::size_t x = first / plane;
    const auto push_runs = [&](std::size_t from) {
      const std::size_t to = from + (end - begin);
      while ((from = first_of(1, free, from, to)) < to) {
        stack_.push_back(from);
        from = first_of(0, free, from, to);
      }
    };
    if (y > 0) push_runs(begin - row);
    if (y + 1 < rows) push_runs(begin + row);
    if (x > 0) push_runs(begin - plane);
    if (x + 1 < static_cast<std::size_t>(size_[0])) push_runs(begin + plane);
  }
}

void ReachGrid::grow(int steps) {
  struct Grown {
    std::size_t cell;
    Label label;
  };
  std::vector<std::size_t> waiting;
  for (std::size_t i = 0; i < labels_.size() && steps > 0; ++i) {
    if (labels_[i] == kUnset) waiting.push_back(i);
  }
  std::vector<Grown> grown;
  for (int step = 0; step < steps; ++step) {
    grown.clear();
    std::size_t left = 0;
    for (const std::size_t cell : waiting) {
      Label label = kUnset;
      for_neighbors(cell, [&](std::size_t next) {
        if (labels_[next] != kSurface) label = std::min(label, labels_[next]);
      });
      if (label != kUnset) {
        grown.push_back({cell, label});
      } else {
        waiting[left++] = cell;
      }
    }
    waiting.resize(left);
    for (const Grown& each : grown) labels_[each.cell] = each.label;
  }
}

ReachGrid::Label ReachGrid::at(const Vector3& point) const {
  std::array<int, 3> cell;
  for (std::size_t a = 0; a < 3; ++a) {
    const double first_beyond_surface = (point[a] - origin_[a]) / cell_;
    if (!(first_beyond_surface >= 0.0) || first_beyond_surface >= size_[a]) return kOutside;
    cell[a] = static_cast<int>(first_beyond_surface);
  }
  return labels_[index(cell[0], cell[1], cell[2])];
}

ReachGrid::Label ReachGrid::first_beyond_surface(const Vector3& point,
                                                 const Vector3& direction) const {
  constexpr double kStep = 0.5;  // cells
  for (double distance = kStep; distance <= kMaxRayCells; distance += kStep) {
    Vector3 there;
    for (std::size_t a = 0; a < 3; ++a) there[a] = point[a] + direction[a] * distance * cell_;
    const Label label = at(there);
    if (label != kSurface) return label;
  }
  return kSurface;
}

}  // namespace prefilter
