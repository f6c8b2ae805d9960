// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/memory.h"

#include <cstdio>

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

void check_memory(const std::string& what, double bytes) {
  // Small amounts are always available; the query would take longer than drawing an icon.
  constexpr double kAlwaysAvailable = 1 << 20;
  if (bytes <= kAlwaysAvailable) return;
  const auto available = static_cast<double>(available_memory());
  if (bytes <= available) return;
  throw Error(ErrorCode::kOutOfMemory, what + " needs about " + in_gigabytes(bytes) + "; " +
                                           in_gigabytes(available) + " are free");
}

}  // namespace prefilter
