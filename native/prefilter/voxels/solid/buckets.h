// SPDX-License-Identifier: GPL-3.0-or-later

// Groups numbers by a key, in parallel.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/parallel.h"

namespace prefilter {

/// Numbers grouped into buckets, sorted within each.
class Buckets {
 public:
  Buckets() = default;

  /// Fills the buckets: `for_items(begin, end, put)` must call put(bucket, number) for each item of
  /// rows [begin, end). It is called twice per range, and must make the same calls both times.
  template <typename ForItems>
  Buckets(std::size_t buckets, std::size_t rows, const ForItems& for_items, const Run& run);

  std::size_t size() const { return starts_.size() - 1; }
  std::span<const std::uint64_t> operator[](std::size_t bucket) const {
    return std::span(numbers_).subspan(starts_[bucket], starts_[bucket + 1] - starts_[bucket]);
  }

 private:
  std::vector<std::uint64_t> starts_ = {0};
  std::vector<std::uint64_t> numbers_;
};

template <typename ForItems>
Buckets::Buckets(std::size_t buckets, std::size_t rows, const ForItems& for_items, const Run& run) {
  constexpr std::int64_t kRowsPerTask = 1 << 14;
  const auto count = static_cast<std::int64_t>(rows);
  starts_.assign(buckets + 1, 0);
  const auto next = [&](std::size_t bucket) {
    return std::atomic_ref(starts_[bucket]).fetch_add(1, std::memory_order_relaxed);
  };
  const Stages stages(run, {3, 5, 2});
  parallel_ranges(count, kRowsPerTask, stages[0], [&](std::int64_t begin, std::int64_t end) {
    for_items(static_cast<std::size_t>(begin), static_cast<std::size_t>(end),
              [&](std::size_t bucket, std::uint64_t) { next(bucket); });
  });
  std::uint64_t sum = 0;
  for (std::uint64_t& start : starts_) {
    sum += start;
    start = sum - start;
  }
  numbers_.resize(sum);
  parallel_ranges(count, kRowsPerTask, stages[1], [&](std::int64_t begin, std::int64_t end) {
    for_items(static_cast<std::size_t>(begin), static_cast<std::size_t>(end),
              [&](std::size_t bucket, std::uint64_t number) { numbers_[next(bucket)] = number; });
  });
  // By now each entry holds the start of the next bucket.
  for (std::size_t bucket = buckets; bucket > 0; --bucket) starts_[bucket] = starts_[bucket - 1];
  starts_[0] = 0;
  parallel_ranges(static_cast<std::int64_t>(buckets), kRowsPerTask, stages[2],
                  [&](std::int64_t begin, std::int64_t end) {
                    for (auto b = static_cast<std::size_t>(begin);
                         b < static_cast<std::size_t>(end); ++b) {
                      const auto first = numbers_.begin();
                      std::sort(first + static_cast<std::ptrdiff_t>(starts_[b]),
                                first + static_cast<std::ptrdiff_t>(starts_[b + 1]));
                    }
                  });
}

}  // namespace prefilter
