// SPDX-License-Identifier: GPL-3.0-or-later

// Numbers in messages.
#pragma once

#include <cstdio>
#include <string>

namespace prefilter {

/// Formats a number with %g: 0.25, 1e-09, nan.
inline std::string to_text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

}  // namespace prefilter
