// SPDX-License-Identifier: GPL-3.0-or-later

#define WIN32_LEAN_AND_MEAN
#define NOMINMAX
#include <windows.h>

#include <algorithm>
#include <limits>

#include "prefilter/base/memory.h"

namespace prefilter {

std::uint64_t available_memory() {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  if (GlobalMemoryStatusEx(&status) == 0) return std::numeric_limits<std::uint64_t>::max();
  // Allocations are also limited by the total of memory and page files.
  return std::min(status.ullAvailPhys, status.ullAvailPageFile);
}

}  // namespace prefilter
