// SPDX-License-Identifier: GPL-3.0-or-later

// Sorts points along the Morton curve through their bounding box.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"
#include "prefilter/geometry/spatial/morton.h"

namespace prefilter {

/// A point's key on the Morton curve, and its index.
struct CurvePlace {
  std::uint64_t key;
  std::uint32_t index;

  bool operator<(const CurvePlace& other) const {
    return key != other.key ? key < other.key : index < other.index;
  }
};

/// The keys of `count` finite points `point_of(i)`, sorted. Points at the same position have the
/// same key.
template <typename PointOf>
std::vector<CurvePlace> along_curve(std::size_t count, const PointOf& point_of, const Run& run) {
  constexpr std::int64_t kRowsPerTask = 1 << 15;
  const auto rows = static_cast<std::int64_t>(count);
  std::vector<Box> boxes(static_cast<std::size_t>(range_count(rows, kRowsPerTask)), kEmptyBox);
  const auto measure = [&](std::int64_t begin, std::int64_t end) {
    Box& box = boxes[static_cast<std::size_t>(begin / kRowsPerTask)];
    for (std::int64_t i = begin; i < end; ++i) box.include(point_of(static_cast<std::size_t>(i)));
  };
  const Stages stages(run, {1, 1, 8});
  parallel_ranges(rows, kRowsPerTask, stages[0], measure);
  Box all = kEmptyBox;
  for (const Box& box : boxes) all.include(box);
  std::vector<CurvePlace> places(count);
  const auto place = [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const Vector3 point = point_of(static_cast<std::size_t>(i));
      std::array<int, 3> cell;
      for (int a = 0; a < 3; ++a) {
        const double size = all.size(a);
        const double along = size > 0.0 ? (point[a] - all.low[a]) / size : 0.0;
        cell[a] = static_cast<int>(along * ((1 << kMortonBits) - 1));
      }
      places[static_cast<std::size_t>(i)] = {morton_index(cell), static_cast<std::uint32_t>(i)};
    }
  };
  parallel_ranges(rows, kRowsPerTask, stages[1], place);
  sort_in_parallel(&places, stages[2]);
  return places;
}

}  // namespace prefilter
