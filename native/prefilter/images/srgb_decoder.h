// SPDX-License-Identifier: GPL-3.0-or-later

// Fast sRGB decoding with its slope, for iterative fits.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace prefilter {

/// srgb_to_linear by linear interpolation in a table: accurate to 1e-7 in [0, 1], and exact up to
/// rounding outside.
class SrgbDecoder {
 public:
  struct Result {
    float value;
    float slope;
  };

  static const SrgbDecoder& instance();

  Result operator()(float encoded) const {
    const float position = encoded * kSteps;
    if (!(position >= 0.0F && position < kSteps)) return outside(encoded);
    const int step = static_cast<int>(position);
    const float slope = table_[step + 1] - table_[step];
    return {table_[step] + (position - static_cast<float>(step)) * slope, slope * kSteps};
  }

 private:
  static constexpr int kSteps = 4096;

  SrgbDecoder();
  static Result outside(float encoded);

  std::vector<float> table_;
};

}  // namespace prefilter
