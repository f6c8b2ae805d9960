// SPDX-License-Identifier: GPL-3.0-or-later

// Progress and cancellation of long work.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

namespace prefilter {

/// Forwards progress to a callback. A copy made by `part` covers a part of the range, so that every
/// function reports from 0 to 1. Only the thread that started the work reports.
class Progress {
 public:
  /// Receives the completed fraction, in [0, 1]; returns false to cancel.
  using Callback = std::function<bool(double)>;

  Progress() = default;
  explicit Progress(Callback callback);

  /// The part [from, to] of this range.
  Progress part(double from, double to) const;

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
};

}  // namespace prefilter
