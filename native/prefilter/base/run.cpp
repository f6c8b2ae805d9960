// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/run.h"

#include <algorithm>
#include <utility>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {
constexpr std::chrono::milliseconds kReportInterval{30};
// A callback may wait for a lock, such as Python's, which should not stall all threads.
constexpr std::chrono::milliseconds kPatience{200};

std::int64_t ticks(std::chrono::steady_clock::duration time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time).count();
}

std::int64_t now_in_ticks() { return ticks(std::chrono::steady_clock::now().time_since_epoch()); }

// Records the time at which a callback was entered, for as long as it runs.
class Call {
 public:
  explicit Call(std::atomic<std::int64_t>* called_at) : called_at_(called_at) {
    called_at_->store(now_in_ticks());
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
  ~Call() {
    called_at_->store(0);
    called_at_->notify_all();
  }

 private:
  std::atomic<std::int64_t>* called_at_;
};
}  // namespace

Run::Run(int threads, Callback callback)
    : state_(callback ? std::make_shared<State>() : nullptr), threads_(threads) {
  if (state_) state_->callback = std::move(callback);
}

Run Run::with_threads(int threads) const {
  Run result = *this;
  result.threads_ = threads;
  return result;
}

Run Run::part(double from, double to) const {
  Run result = *this;
  result.from_ = from_ + (to_ - from_) * from;
  result.to_ = from_ + (to_ - from_) * to;
  return result;
}

void Run::report(double fraction) const {
  if (!state_) return;
  const double whole =
      std::max(state_->highest, from_ + (to_ - from_) * std::clamp(fraction, 0.0, 1.0));
  const auto now = std::chrono::steady_clock::now();
  if (whole < 1.0 && now - state_->last < kReportInterval) return;
  state_->last = now;
  state_->highest = whole;
  const Call call(&state_->called_at);
  if (!state_->callback(whole)) throw Error(ErrorCode::kCancelled, "cancelled");
}

void Run::wait_while_held() const {
  if (!state_) return;
  while (true) {
    const std::int64_t called_at = state_->called_at.load(std::memory_order_relaxed);
    if (called_at == 0 || now_in_ticks() - called_at < ticks(kPatience)) return;
    state_->called_at.wait(called_at);
  }
}

Stages::Stages(const Run& run, std::initializer_list<double> weights) : run_(run) {
  double sum = 0.0;
  for (const double weight : weights) sum += weight;
  double before = 0.0;
  for (const double weight : weights) {
    begins_.push_back(before / sum);
    before += weight;
  }
  begins_.push_back(1.0);
}

}  // namespace prefilter
