// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/memory.h"

#include <fstream>
#include <limits>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"

namespace prefilter {
namespace {
std::string in_gigabytes(double bytes) {
  const double gigabytes = bytes / 1e9;
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, gigabytes < 10.0 ? "%.2g GB" : "%.0f GB", gigabytes);
  return buffer;
}
}  // namespace

std::uint64_t available_memory() {
  // Linux tells it here; other systems have no such file.
  std::ifstream info("/proc/meminfo");
  std::string key;
  std::uint64_t kilobytes = 0;
  while (info >> key >> kilobytes) {
    if (key == "MemAvailable:") return kilobytes * 1024;
    info.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return std::numeric_limits<std::uint64_t>::max();
}

void check_memory(const std::string& what, double bytes) {
  const auto available = static_cast<double>(available_memory());
  if (bytes <= available) return;
  throw Error(ErrorCode::kOutOfMemory, what + " needs about " + in_gigabytes(bytes) + "; " +
                                           in_gigabytes(available) + " are free");
}

}  // namespace prefilter
