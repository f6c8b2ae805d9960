// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/moments/axis_parts.h"

namespace prefilter {

AxisParts::AxisParts(const std::vector<double>& lines, int first_line, int last_line,
                     double scale) {
  const double begin = scale * lines[first_line];
  for (int k = first_line; k < last_line; ++k) {
    const double low = scale * lines[k];
    const double high = scale * lines[k + 1];
    const int cell = static_cast<int>(std::floor(0.5 * (low + high) - begin));
    while (static_cast<int>(first_of_.size()) <= cell) first_of_.push_back(k - first_line);
    lows_.push_back(low);
    widths_.push_back(high - low);
  }
  first_of_.push_back(last_line - first_line);
}

}  // namespace prefilter
