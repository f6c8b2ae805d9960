// SPDX-License-Identifier: GPL-3.0-or-later

// Cancellation in loops with an unknown number of steps.
#pragma once

#include <cstdint>

#include "prefilter/base/run.h"

namespace prefilter {

/// Reports 0 progress every few thousand steps, so that long sorts and library loops can be
/// cancelled. The progress must outlive it.
class CancelCheck {
 public:
  explicit CancelCheck(const Run& run) : run_(run) {}
  void step() {
    if (++steps_ % kStepsPerReport == 0) run_.report(0.0);
  }

 private:
  static constexpr std::uint32_t kStepsPerReport = 1 << 12;
  const Run& run_;
  std::uint32_t steps_ = 0;
};

}  // namespace prefilter
