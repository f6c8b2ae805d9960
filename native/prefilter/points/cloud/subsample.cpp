// SPDX-License-Identifier: GPL-3.0-or-later

// Poisson-disk sampling by dart throwing in a pseudorandom order, and grid sampling.
#include "prefilter/points/subsample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"
#include "prefilter/base/text.h"
#include "prefilter/geometry/spatial/nearest_neighbors.h"

namespace prefilter {
namespace {

constexpr double kMaxCells = 1e15;  // along an axis; larger indices are not exact in doubles
constexpr std::int64_t kCellsPerTask = 1 << 14;

// splitmix64 (Steele et al. 2014): a bijective scrambling.
std::uint64_t scramble(std::uint64_t number) {
  number += 0x9E3779B97F4A7C15U;
  number = (number ^ (number >> 30)) * 0xBF58476D1CE4E5B9U;
  number = (number ^ (number >> 27)) * 0x94D049BB133111EBU;
  return number ^ (number >> 31);
}

void check_spacing(double spacing, const Box& box) {
  double extent = 0.0;
  for (int a = 0; a < 3; ++a) extent = std::max(extent, box.size(a));
  if (spacing > 0.0 && std::isfinite(spacing) && extent / spacing < kMaxCells) return;
  throw_invalid("spacing: found " + to_text(spacing) + "; a number above " +
                to_text(std::max(extent, 0.0) / kMaxCells) + " is needed");
}

// The first point at each distinct position.
std::vector<std::int64_t> first_points(const NeighborSearch& search) {
  std::vector<std::int64_t> first(search.positions().size());
  const std::span<const std::uint32_t> places = search.places();
  for (std::size_t i = places.size(); i-- > 0;) {
    if (places[i] != NeighborSearch::kNowhere) first[places[i]] = static_cast<std::int64_t>(i);
  }
  return first;
}

struct RandomRank {
  std::uint64_t number = 0;
  std::uint32_t place = 0;
  bool operator<(const RandomRank& other) const { return number < other.number; }
};

// Dart throwing: each position in turn is kept, and removes all positions that are too near.
std::vector<std::int64_t> poisson_points(const NeighborSearch& search, double spacing,
                                         const Run& run) {
  const std::span<const Vector3> positions = search.positions();
  std::vector<RandomRank> ranks(positions.size());
  for (std::uint32_t place = 0; place < ranks.size(); ++place) {
    ranks[place] = {scramble(place), place};
  }
  const Stages stages(run, {1, 9});
  sort_in_parallel(&ranks, stages[0]);
  const std::vector<std::int64_t> first = first_points(search);
  std::vector<bool> is_out(positions.size());
  std::vector<std::int64_t> kept;
  const double square = spacing * spacing;
  constexpr std::size_t kPerReport = 1 << 10;
  const Run rest = stages[1];
  for (std::size_t t = 0; t < ranks.size(); ++t) {
    if (t % kPerReport == 0) {
      rest.report(static_cast<double>(t) / static_cast<double>(ranks.size()));
    }
    const std::uint32_t place = ranks[t].place;
    if (is_out[place]) continue;
    kept.push_back(first[place]);
    search.for_near(positions[place], square, [&](std::uint32_t near) { is_out[near] = true; });
  }
  return kept;
}

struct CellPoint {
  std::array<std::int64_t, 3> cell{};
  std::int64_t index = 0;
  bool operator<(const CellPoint& other) const {
    return cell != other.cell ? cell < other.cell : index < other.index;
  }
};

// The point of a cell nearest to the mean of the cell.
std::int64_t central_point(std::span<const Vector3> points, std::span<const CellPoint> cell) {
  const Vector3 origin = points[static_cast<std::size_t>(cell.front().index)];
  Vector3 mean{};
  for (const CellPoint& each : cell) {
    mean = mean + (points[static_cast<std::size_t>(each.index)] - origin);
  }
  mean = origin + 1.0 / static_cast<double>(cell.size()) * mean;
  std::int64_t nearest = cell.front().index;
  double least = std::numeric_limits<double>::infinity();
  for (const CellPoint& each : cell) {
    const Vector3 offset = points[static_cast<std::size_t>(each.index)] - mean;
    if (const double square = dot(offset, offset); square < least) {
      least = square;
      nearest = each.index;
    }
  }
  return nearest;
}

std::vector<std::int64_t> grid_points(std::span<const Vector3> points, const NeighborSearch& search,
                                      double spacing, const Run& run) {
  const Vector3 low = search.box().low;
  std::vector<CellPoint> cells;
  cells.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (search.places()[i] != NeighborSearch::kNowhere) {
      cells.push_back({{}, static_cast<std::int64_t>(i)});
    }
  }
  const auto place = [&](std::int64_t begin, std::int64_t end) {
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c) {
      const Vector3 offset = points[static_cast<std::size_t>(cells[c].index)] - low;
      for (std::size_t a = 0; a < 3; ++a) {
        cells[c].cell[a] = static_cast<std::int64_t>(offset[a] / spacing);
      }
    }
  };
  const Stages stages(run, {1, 8, 1});
  parallel_ranges(static_cast<std::int64_t>(cells.size()), kCellsPerTask, stages[0], place);
  sort_in_parallel(&cells, stages[1]);
  std::vector<std::int64_t> kept;
  const Run last = stages[2];
  CancelCheck cancel_check(last);
  for (std::size_t begin = 0, end = 0; begin < cells.size(); begin = end) {
    while (end < cells.size() && cells[end].cell == cells[begin].cell) {
      cancel_check.step();
      ++end;
    }
    kept.push_back(central_point(points, std::span(cells).subspan(begin, end - begin)));
  }
  return kept;
}

}  // namespace

std::vector<std::int64_t> subsample(std::span<const Vector3> points, double spacing,
                                    Subsampling method, const Run& run) {
  const Stages stages(run, {3, 7});
  const NeighborSearch search(points, stages[0]);
  check_spacing(spacing, search.positions().empty() ? Box{} : search.box());
  const Run rest = stages[1];
  std::vector<std::int64_t> kept = method == Subsampling::kPoisson
                                       ? poisson_points(search, spacing, rest)
                                       : grid_points(points, search, spacing, rest);
  std::sort(kept.begin(), kept.end());
  run.report(1.0);
  return kept;
}

}  // namespace prefilter
