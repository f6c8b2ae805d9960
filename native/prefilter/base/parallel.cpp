#include "prefilter/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace prefilter {
namespace {
constexpr int kMaxThreads = 64;
}

int resolve_threads(int threads) {
  if (threads > 0) return std::min(threads, kMaxThreads);
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for(std::int64_t count, int threads, const Progress& progress,
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
        body(i);
        if (reports) progress.report(static_cast<double>(i + 1) / static_cast<double>(count));
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      stop.store(true, std::memory_order_relaxed);
    }
  };

  const auto helper_count =
      static_cast<int>(std::min<std::int64_t>(resolve_threads(threads), count)) - 1;
  {
    std::vector<std::jthread> helpers;
    for (int i = 0; i < helper_count; ++i) helpers.emplace_back(work, false);
    work(true);
  }
  if (failure) std::rethrow_exception(failure);
}

void parallel_team(int threads, const std::function<void(Team&)>& body) {
  if (threads <= 1) {
    Team alone(0, 1, nullptr);
    body(alone);
    return;
  }
  std::barrier<> barrier(threads);
  std::vector<std::jthread> helpers;
  helpers.reserve(static_cast<std::size_t>(threads));
  for (int rank = 1; rank < threads; ++rank) {
    helpers.emplace_back([&, rank] {
      Team member(rank, threads, &barrier);
      body(member);
    });
  }
  Team member(0, threads, &barrier);
  body(member);
}

}  // namespace prefilter
