// SPDX-License-Identifier: GPL-3.0-or-later

#include <fstream>
#include <limits>
#include <string>

#include "prefilter/base/memory.h"

namespace prefilter {

std::uint64_t available_memory() {
  std::ifstream info("/proc/meminfo");
  std::string key;
  std::uint64_t kilobytes = 0;
  while (info >> key >> kilobytes) {
    if (key == "MemAvailable:") return kilobytes * 1024;
    info.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return std::numeric_limits<std::uint64_t>::max();
}

}  // namespace prefilter
