// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace prefilter {
namespace {
constexpr int kMaxThreads = 64;

// Up to `count` threads, each running body(rank) with ranks from 1; fewer if the system cannot
// create more. The destructor joins them. (std::jthread is hidden in libc++ before version 20.)
class WorkerThreads {
 public:
  template <typename Body>
  WorkerThreads(int count, const Body& body) {
    threads_.reserve(static_cast<std::size_t>(std::max(count, 0)));
    try {
      for (int rank = 1; rank <= count; ++rank) threads_.emplace_back(body, rank);
    } catch (const std::exception&) {
      // Thread creation failed: the work is shared among the existing threads.
    }
  }
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;
  ~WorkerThreads() {
    for (std::thread& thread : threads_) thread.join();
  }

  int count() const { return static_cast<int>(threads_.size()); }

 private:
  std::vector<std::thread> threads_;
};
}  // namespace

int resolve_threads(int threads) {
  if (threads > 0) return std::min(threads, kMaxThreads);
  // Cached, as the system reads a file, which takes longer than drawing an icon.
  static const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return processors;
}

void parallel_for(std::int64_t count, const Run& run,
                  const std::function<void(std::int64_t)>& body) {
  std::atomic<std::int64_t> next{0};
  std::atomic<bool> stop{false};
  std::exception_ptr failure;
  std::mutex failure_mutex;

  const auto work = [&](bool reports) {
    try {
      while (!stop.load(std::memory_order_relaxed)) {
        const std::int64_t i = next.fetch_add(1, std::memory_order_relaxed);
        if (i >= count) break;
        if (!reports) run.wait_while_held();
        body(i);
        if (reports) run.report(static_cast<double>(i + 1) / static_cast<double>(count));
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      stop.store(true, std::memory_order_relaxed);
    }
  };

  const auto helper_count =
      static_cast<int>(std::min<std::int64_t>(resolve_threads(run.threads()), count)) - 1;
  {
    const WorkerThreads workers(helper_count, [&](int) { work(false); });
    work(true);
  }
  if (failure) std::rethrow_exception(failure);
  run.report(1.0);  // another thread may have finished last
}

void parallel_ranges(std::int64_t count, std::int64_t grain, const Run& run,
                     const std::function<void(std::int64_t, std::int64_t)>& body) {
  assert(count >= 0 && grain >= 1);
  parallel_for(range_count(count, grain), run, [&](std::int64_t range) {
    const std::int64_t begin = range * grain;
    body(begin, begin + std::min(grain, count - begin));
  });
}

void parallel_team(int threads, const std::function<void(Team&)>& body) {
  if (threads <= 1) {
    Team alone(0, 1, nullptr);
    body(alone);
    return;
  }
  // The barrier is created once the number of threads is known; until then they wait.
  std::optional<std::barrier<>> barrier;
  std::atomic<int> size{0};
  const WorkerThreads workers(threads - 1, [&](int rank) {
    size.wait(0);
    Team member(rank, size, &*barrier);
    body(member);
  });
  const int team_size = workers.count() + 1;
  barrier.emplace(team_size);
  size.store(team_size);
  size.notify_all();
  Team member(0, team_size, &*barrier);
  body(member);
}

}  // namespace prefilter
