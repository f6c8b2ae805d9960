// SPDX-License-Identifier: GPL-3.0-or-later

// Local outlier detection: the mean neighbor distance is compared with its median over the
// neighbors.
#include "prefilter/points/outliers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/geometry/spatial/nearest_neighbors.h"

namespace prefilter {
namespace {

constexpr int kMinOutlierNeighbors = 3;
constexpr int kMaxOutlierNeighbors = 1000;
constexpr std::int64_t kPointsPerTask = 256;

void check_arguments(int neighbours, double factor) {
  if (neighbours < kMinOutlierNeighbors || neighbours > kMaxOutlierNeighbors) {
    throw_invalid("neighbours: found " + std::to_string(neighbours) + "; a number from " +
                  std::to_string(kMinOutlierNeighbors) + " to " +
                  std::to_string(kMaxOutlierNeighbors) + " is needed");
  }
  if (!(factor > 1.0) || !std::isfinite(factor)) {
    throw_invalid("factor: found " + to_text(factor) + "; a number above 1 is needed");
  }
}

}  // namespace

std::vector<bool> find_outliers(std::span<const Vector3> points, int neighbours, double factor,
                                const Run& run) {
  check_arguments(neighbours, factor);
  const Stages stages(run, {1, 2, 2});
  const NeighborSearch search(points, stages[0]);
  const std::size_t places = search.positions().size();
  std::vector<bool> result(points.size());
  // a position is its own nearest neighbor
  const auto search_count = static_cast<std::size_t>(neighbours) + 1;
  std::vector<double> distances(places);
  const auto measure = [&](std::int64_t begin, std::int64_t end) {
    Neighbors near;
    for (auto place = static_cast<std::uint32_t>(begin); place < end; ++place) {
      search.find(place, search_count, &near);
      double sum = 0.0;
      for (const double square : near.squares()) sum += std::sqrt(square);
      distances[place] =
          sum / static_cast<double>(std::max<std::size_t>(near.places().size(), 2) - 1);
    }
  };
  std::vector<std::uint8_t> is_outlier(places);
  const auto compare = [&](std::int64_t begin, std::int64_t end) {
    Neighbors near;
    std::vector<double> others;
    for (auto place = static_cast<std::uint32_t>(begin); place < end; ++place) {
      search.find(place, search_count, &near);
      others.clear();
      for (const std::uint32_t other : near.places().subspan(1)) others.push_back(distances[other]);
      const auto middle = others.begin() + static_cast<std::ptrdiff_t>((others.size() - 1) / 2);
      std::nth_element(others.begin(), middle, others.end());
      is_outlier[place] = distances[place] > factor * *middle ? 1 : 0;
    }
  };
  if (places > static_cast<std::size_t>(kMinOutlierNeighbors)) {
    const auto count = static_cast<std::int64_t>(places);
    parallel_ranges(count, kPointsPerTask, stages[1], measure);
    parallel_ranges(count, kPointsPerTask, stages[2], compare);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t place = search.places()[i];
    result[i] = place == NeighborSearch::kNowhere || is_outlier[place] != 0;
  }
  run.report(1.0);
  return result;
}

}  // namespace prefilter
