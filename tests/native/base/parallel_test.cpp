// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

TEST(ParallelFor, VisitsEveryIndexOnce) {
  for (const int threads : {1, 2, 7}) {
    std::vector<std::atomic<int>> visits(1000);
    parallel_for(1000, prefilter::Run(threads), [&](std::int64_t i) { ++visits[i]; });
    for (const std::atomic<int>& count : visits) EXPECT_EQ(count, 1);
  }
}

TEST(ParallelFor, PassesOnTheExceptionOfABody) {
  const auto fail = [] {
    parallel_for(100, prefilter::Run(3), [](std::int64_t i) {
      if (i == 17) throw std::runtime_error("seventeen");
    });
  };
  EXPECT_THROW(fail(), std::runtime_error);
}

TEST(ParallelFor, ReportsTheEndWhenAWorkerIsLast) {
  const std::thread::id caller = std::this_thread::get_id();
  std::vector<double> seen;
  const prefilter::Run run([&](double fraction) {
    seen.push_back(fraction);
    return true;
  });
  parallel_for(2, run.with_threads(2), [&](std::int64_t) {
    const bool is_caller = std::this_thread::get_id() == caller;
    std::this_thread::sleep_for(std::chrono::milliseconds(is_caller ? 10 : 200));
  });
  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(seen.back(), 1.0);
}

TEST(ParallelFor, StopsSoonWhenCancelled) {
  constexpr std::int64_t kCount = 10000;
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<bool> is_cancelled = false;
  std::atomic<int> visits_after = 0;
  const prefilter::Run run([&](double fraction) {
    if (fraction < 0.01) return true;
    is_cancelled = true;
    return false;
  });
  const auto visit_all = [&] {
    parallel_for(kCount, run.with_threads(2), [&](std::int64_t) {
      // The worker thread is held back until then, regardless of scheduling.
      while (std::this_thread::get_id() != caller && !is_cancelled) std::this_thread::yield();
      if (is_cancelled) ++visits_after;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    });
  };
  EXPECT_THROW(visit_all(), Error);
  // The index in which the worker was held, and indices that it started before the caller returned
  // from its report. Without cancellation it would visit all the remaining ones.
  EXPECT_LT(visits_after, kCount / 2);
}

TEST(ParallelFor, WorkersWaitForThePausedCallback) {
  std::atomic<int> visits = 0;
  int before = 0;
  int after = 0;
  const prefilter::Run run([&](double fraction) {
    if (fraction < 1.0 && after == 0) {
      // Workers continue for a fifth of a second, and finish the current index, later on a busy
      // machine.
      do {
        before = visits;
        std::this_thread::sleep_for(std::chrono::milliseconds(400));
        after = visits;
      } while (after != before);
    }
    return true;
  });
  parallel_for(2000, run.with_threads(3), [&](std::int64_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ++visits;
  });
  EXPECT_GT(after, 0);
  // Without waiting they would have visited all other indices.
  EXPECT_LT(after, 1500);
  EXPECT_EQ(visits, 2000);
}

TEST(ParallelRanges, AreWholeGrainsAndTheRest) {
  for (const std::int64_t count : {0, 1, 6, 7, 8, 14, 100}) {
    std::vector<std::atomic<int>> visits(static_cast<std::size_t>(count));
    std::atomic<int> ranges{0};
    parallel_ranges(count, 7, prefilter::Run(3), [&](std::int64_t begin, std::int64_t end) {
      EXPECT_EQ(begin % 7, 0);
      EXPECT_EQ(end, std::min(count, begin + 7));
      for (std::int64_t i = begin; i < end; ++i) ++visits[i];
      ++ranges;
    });
    EXPECT_EQ(ranges, range_count(count, 7));
    for (const std::atomic<int>& visit : visits) EXPECT_EQ(visit, 1);
  }
}

TEST(ParallelTeam, StepsTogether) {
  std::vector<int> steps(4);
  parallel_team(4, [&](Team& team) {
    for (int step = 0; step < 100; ++step) {
      steps[team.rank()] = step;
      team.wait_for_all();
      for (const int other : steps) EXPECT_EQ(other, step);
      team.wait_for_all();
    }
  });
}

TEST(ParallelTeam, SharesCoverTheWhole) {
  std::vector<std::atomic<int>> visits(101);
  parallel_team(3, [&](Team& team) {
    for (std::int64_t i = team.share_begin(101); i < team.share_end(101); ++i) ++visits[i];
  });
  for (const std::atomic<int>& count : visits) EXPECT_EQ(count, 1);
}

TEST(ProgressTest, PartsCoverTheirShareAndRise) {
  std::vector<double> seen;
  const prefilter::Run run([&](double fraction) {
    seen.push_back(fraction);
    return true;
  });
  run.part(0.0, 0.5).report(1.0);
  std::this_thread::sleep_for(std::chrono::milliseconds(40));
  run.part(0.5, 1.0).part(0.0, 0.5).report(0.5);
  run.report(1.0);
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_DOUBLE_EQ(seen[0], 0.5);
  EXPECT_DOUBLE_EQ(seen[1], 0.625);
  EXPECT_DOUBLE_EQ(seen[2], 1.0);
}

TEST(ProgressTest, NeverFallsBack) {
  std::vector<double> seen;
  const prefilter::Run run([&](double fraction) {
    seen.push_back(fraction);
    return true;
  });
  run.report(0.75);
  std::this_thread::sleep_for(std::chrono::milliseconds(40));
  run.report(0.25);
  EXPECT_EQ(seen, (std::vector<double>{0.75, 0.75}));
}

}  // namespace
}  // namespace prefilter
