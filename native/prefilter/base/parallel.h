// SPDX-License-Identifier: GPL-3.0-or-later

// Parallel loops whose results do not depend on the number of threads: each index only writes its
// own data, and the caller adds up per-index sums in order.
#pragma once

#include <barrier>
#include <cstdint>
#include <functional>

#include "prefilter/base/run.h"

namespace prefilter {

/// The number of threads for an argument: itself, at most 64, or for 0 one per processor.
int resolve_threads(int threads);

/// Calls body(i) once for every i in [0, count), on up to `threads` threads, in unspecified order.
/// Rethrows the first exception of a body. The calling thread participates, and reports to
/// `progress` between its indices. If that cancels, the others stop after their current index;
/// while its callback waits, they wait too.
void parallel_for(std::int64_t count, const Run& run,
                  const std::function<void(std::int64_t)>& body);

/// Number of ranges that parallel_ranges divides [0, count) into: count / grain, rounded up.
constexpr std::int64_t range_count(std::int64_t count, std::int64_t grain) {
  return count / grain + (count % grain != 0 ? 1 : 0);
}

/// Calls body(begin, end) for every range of [0, count) from a multiple of `grain`, at least 1, to
/// the next or to the end. For indices that are too cheap to be scheduled individually. Range b /
/// grain starts at b.
void parallel_ranges(std::int64_t count, std::int64_t grain, const Run& run,
                     const std::function<void(std::int64_t, std::int64_t)>& body);

/// A team of threads that execute the same steps together.
class Team {
 public:
  Team(int rank, int size, std::barrier<>* barrier) : rank_(rank), size_(size), barrier_(barrier) {}
  int rank() const { return rank_; }  // 0 is the thread that called parallel_team
  int size() const { return size_; }
  void wait_for_all() {
    if (barrier_ != nullptr) barrier_->arrive_and_wait();
  }
  /// This member's part of [0, count): contiguous, in order of rank.
  std::int64_t share_begin(std::int64_t count) const { return count * rank_ / size_; }
  std::int64_t share_end(std::int64_t count) const { return count * (rank_ + 1) / size_; }

 private:
  int rank_;
  int size_;
  std::barrier<>* barrier_;
};

/// Runs body on `threads` threads concurrently, or on as many as the system can create. The body
/// must not throw, and all members must make the same calls of wait_for_all.
void parallel_team(int threads, const std::function<void(Team&)>& body);

}  // namespace prefilter
