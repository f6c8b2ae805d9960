// SPDX-License-Identifier: GPL-3.0-or-later

#include "bench/peak_memory.h"

#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace prefilter::bench {
namespace {

/// A field of /proc/self/status that is given in kB, in MiB; 0 where there is none.
double status_field(const std::string& name) {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    if (word != name) continue;
    double kilobytes = 0.0;
    status >> kilobytes;
    return kilobytes / 1024.0;
  }
  return 0.0;
}

}  // namespace

PeakMemory::PeakMemory() {
  malloc_trim(0);  // reuse of memory freed earlier would go unmeasured
  std::ofstream("/proc/self/clear_refs") << "5";
  start_ = status_field("VmRSS:");
}

double PeakMemory::added() const { return std::max(0.0, status_field("VmHWM:") - start_); }

}  // namespace prefilter::bench
