// SPDX-License-Identifier: GPL-3.0-or-later

// Progress, cancellation and number of threads of long work.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

namespace prefilter {

/// Forwards progress to a callback and carries the number of threads. A copy made by `part` covers
/// a part of the range, so that every function reports from 0 to 1. Only the thread that started
/// the work reports.
class Run {
 public:
  /// Receives the completed fraction, in [0, 1]; returns false to cancel.
  using Callback = std::function<bool(double)>;

  /// Work that reports to nobody, on one thread per processor.
  Run() = default;
  /// `threads`: the number of threads that the work may use; 0 for one per processor.
  explicit Run(int threads, Callback callback = {});
  explicit Run(Callback callback) : Run(0, std::move(callback)) {}

  /// The number of threads asked for; 0 stands for one per processor.
  int threads() const { return threads_; }

  /// The same work on another number of threads.
  Run with_threads(int threads) const;

  /// The part [from, to] of this range.
  Run part(double from, double to) const;

  /// Calls the callback at most every 30 ms, and always at 1, with nondecreasing fractions. Throws
  /// Error(kCancelled) if it returns false.
  void report(double fraction) const;

  /// If the callback has been running for more than a fifth of a second, waits until it returns. A
  /// callback can thus pause the whole work by waiting: worker threads call this between indices.
  void wait_while_held() const;

 private:
  struct State {
    Callback callback;
    std::chrono::steady_clock::time_point last;
    double highest = 0.0;
    std::atomic<std::int64_t> called_at{0};  // time of the call in progress, else 0
  };
  std::shared_ptr<State> state_;
  double from_ = 0.0;
  double to_ = 1.0;
  int threads_ = 0;
};

/// Consecutive stages of a run, whose parts of its range are proportional to their weights.
class Stages {
 public:
  /// The weights are at least 0, and one of them is greater.
  Stages(const Run& run, std::initializer_list<double> weights);

  /// The run of stage `index`, counted from 0.
  Run operator[](std::size_t index) const { return run_.part(begins_[index], begins_[index + 1]); }

 private:
  Run run_;
  std::vector<double> begins_;  // the fraction at which each stage begins, and 1
};

}  // namespace prefilter
