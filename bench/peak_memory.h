// SPDX-License-Identifier: GPL-3.0-or-later

// How much memory a piece of work takes at its peak. Linux only; elsewhere it reads 0.
#pragma once

namespace prefilter::bench {

/// Measures from its construction on. One at a time: it resets the process's own mark.
class PeakMemory {
 public:
  PeakMemory();

  /// Peak resident memory since construction, beyond the resident memory at the start [MiB].
  double added() const;

 private:
  double start_;
};

}  // namespace prefilter::bench
