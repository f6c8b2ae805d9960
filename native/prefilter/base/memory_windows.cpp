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
  // Memory is promised only up to a limit, that of page files and memory together.
  return std::min(status.ullAvailPhys, status.ullAvailPageFile);
}

}  // namespace prefilter
