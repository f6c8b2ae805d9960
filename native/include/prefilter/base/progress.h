// SPDX-License-Identifier: GPL-3.0-or-later

// Progress of long work, and the way to stop it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

namespace prefilter {

/// Passes progress on to a callback. A copy that `part` makes covers a share of the whole, so a
/// function reports 0 to 1 whatever it is a part of. Only the thread that started the work reports.
class Progress {
 public:
  /// Is given the fraction done, in [0, 1]; returns false to stop the work.
  using Callback = std::function<bool(double)>;

  Progress() = default;
  explicit Progress(Callback callback);

  /// The share [from, to] of this one's range.
  Progress part(double from, double to) const;

  /// Tells the callback, at most every 30 ms and always at 1; what it is told never falls. Throws
  /// Error(kCancelled) where it answers false.
  void report(double fraction) const;

  /// Waits until the callback returns, where it has not for a fifth of a second: one that pauses
  /// the work by waiting pauses the threads too that do not report. They call this between indices.
  void wait_while_held() const;

 private:
  struct State {
    Callback callback;
    std::chrono::steady_clock::time_point last;
    double highest = 0.0;
    std::atomic<std::int64_t> called_at{0};  // When the callback was entered; 0 outside of it.
  };
  std::shared_ptr<State> state_;
  double from_ = 0.0;
  double to_ = 1.0;
};

}  // namespace prefilter
