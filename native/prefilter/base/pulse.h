// SPDX-License-Identifier: GPL-3.0-or-later

// Canceling in the middle of steps whose number is not known.
#pragma once

#include <cstdint>

#include "prefilter/base/progress.h"

namespace prefilter {

/// Reports that a part of the work is at its beginning, every some thousand steps: what a long sort
/// or a library's loop has to offer for a cancel to be heard. The progress must outlive it.
class Pulse {
 public:
  explicit Pulse(const Progress& progress) : progress_(progress) {}
  void step() {
    if (++steps_ % kStepsPerReport == 0) progress_.report(0.0);
  }

 private:
  static constexpr std::uint32_t kStepsPerReport = 1 << 12;
  const Progress& progress_;
  std::uint32_t steps_ = 0;
};

}  // namespace prefilter
