// SPDX-License-Identifier: GPL-3.0-or-later

// Parallel loops whose results do not depend on the number of threads: each index writes only what
// is its own, and sums are kept per index and added up in order by the caller.
#pragma once

#include <barrier>
#include <cstdint>
#include <functional>

#include "prefilter/base/progress.h"

namespace prefilter {

/// The number of threads that an argument asks for: itself (64 at the most), or for 0 one per
/// processor.
int resolve_threads(int threads);

/// Calls body(i) once for every i in [0, count), on up to `threads` threads, in no set order.
/// Rethrows the first exception of a body. The calling thread takes part and reports to `progress`
/// between its indices; where that cancels, the others stop after the index in hand, and while that
/// waits, so do they.
void parallel_for(std::int64_t count, int threads, const Progress& progress,
                  const std::function<void(std::int64_t)>& body);

/// How many ranges parallel_ranges makes of [0, count): count / grain, rounded up.
constexpr std::int64_t range_count(std::int64_t count, std::int64_t grain) {
  return count / grain + (count % grain != 0 ? 1 : 0);
}

/// Calls body(begin, end) for every range of [0, count) from a multiple of `grain`, 1 or more, to
/// the next or to the end: parallel_for over range_count(count, grain) ranges, where what an index
/// takes is too short to be handed out by itself. The range that begins at b is number b / grain.
void parallel_ranges(std::int64_t count, std::int64_t grain, int threads, const Progress& progress,
                     const std::function<void(std::int64_t, std::int64_t)>& body);

/// A group of threads that walk through the same steps together.
class Team {
 public:
  Team(int rank, int size, std::barrier<>* barrier) : rank_(rank), size_(size), barrier_(barrier) {}
  int rank() const { return rank_; }  // 0 is the thread that called parallel_team
  int size() const { return size_; }
  void wait_for_all() {
    if (barrier_ != nullptr) barrier_->arrive_and_wait();
  }
  /// This member's share of [0, count): contiguous, in order of rank.
  std::int64_t share_begin(std::int64_t count) const { return count * rank_ / size_; }
  std::int64_t share_end(std::int64_t count) const { return count * (rank_ + 1) / size_; }

 private:
  int rank_;
  int size_;
  std::barrier<>* barrier_;
};

/// Runs body on `threads` threads at once, or on as many as the system has. The body must not
/// throw, and all members must reach the same calls of wait_for_all.
void parallel_team(int threads, const std::function<void(Team&)>& body);

}  // namespace prefilter
