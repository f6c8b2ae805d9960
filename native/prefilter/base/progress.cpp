// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/progress.h"

#include <algorithm>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {
constexpr std::chrono::milliseconds kInterval{30};
}

Progress::Progress(Callback callback)
    : state_(callback ? std::make_shared<State>(State{std::move(callback), {}, 0.0}) : nullptr) {}

Progress Progress::part(double from, double to) const {
  Progress result = *this;
  result.from_ = from_ + (to_ - from_) * from;
  result.to_ = from_ + (to_ - from_) * to;
  return result;
}

void Progress::report(double fraction) const {
  if (!state_) return;
  const double whole =
      std::max(state_->highest, from_ + (to_ - from_) * std::clamp(fraction, 0.0, 1.0));
  const auto now = std::chrono::steady_clock::now();
  if (whole < 1.0 && now - state_->last < kInterval) return;
  state_->last = now;
  state_->highest = whole;
  if (!state_->callback(whole)) throw Error(ErrorCode::kCancelled, "cancelled");
}

}  // namespace prefilter
