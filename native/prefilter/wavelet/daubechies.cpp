// SPDX-License-Identifier: GPL-3.0-or-later

// Tabulates phi and its integral by the refinement relation.
#include "prefilter/wavelet/daubechies.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace prefilter::d4 {
namespace {

constexpr std::size_t kStepsPerUnit = 64;  // per unit

// A function on [0, 3] in steps of 1/64, from its values at integers by g(t) = scale * sum of
// kLow[l] g(2 t - l); g is 0 below and `beyond` above.
std::vector<double> refined(double at_1, double at_2, double beyond, double scale) {
  std::vector<double> values(3 * kStepsPerUnit + 1);
  values[kStepsPerUnit] = at_1;
  values[2 * kStepsPerUnit] = at_2;
  values[3 * kStepsPerUnit] = beyond;
  const auto last = static_cast<std::ptrdiff_t>(3 * kStepsPerUnit);
  for (std::size_t step = kStepsPerUnit / 2; step >= 1; step /= 2) {
    for (std::size_t i = step; i < values.size(); i += 2 * step) {
      double sum = 0.0;
      for (std::size_t l = 0; l < 4; ++l) {
        const std::ptrdiff_t at =
            static_cast<std::ptrdiff_t>(2 * i) - static_cast<std::ptrdiff_t>(l * kStepsPerUnit);
        if (at >= last) {
          sum += kLow[l] * beyond;
        } else if (at > 0) {
          sum += kLow[l] * values[static_cast<std::size_t>(at)];
        }
      }
      values[i] = scale * sum;
    }
  }
  return values;
}

std::array<Values, kStepsPerUnit + 1> make_table() {
  const std::vector<double> phi = refined((1.0 + kSqrt3) / 2.0, (1.0 - kSqrt3) / 2.0, 0.0, 1.0);
  // The integral's values x at 1 and y at 2: 2 x = kLow[0] y + kLow[1] x, and 2 y = kLow[0] +
  // kLow[1] + kLow[2] y + kLow[3] x.
  const double ratio = (2.0 - kLow[1]) / kLow[0];
  const double x = (kLow[0] + kLow[1]) / ((2.0 - kLow[2]) * ratio - kLow[3]);
  const std::vector<double> integral = refined(x, ratio * x, 1.0, 0.5);
  std::array<Values, kStepsPerUnit + 1> table;
  for (std::size_t i = 0; i <= kStepsPerUnit; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      table[i].phi[k] = static_cast<float>(phi[i + k * kStepsPerUnit]);
    double before = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double here = k < 3 ? integral[i + k * kStepsPerUnit] : 1.0;
      table[i].lambda[k] = static_cast<float>(here - before);
      before = here;
    }
  }
  return table;
}

}  // namespace

Values values_at(float f) {
  static const std::array<Values, kStepsPerUnit + 1> kTable = make_table();
  const float at = std::clamp(f, 0.0F, 1.0F) * static_cast<float>(kStepsPerUnit);
  const std::size_t i = std::min(static_cast<std::size_t>(at), kStepsPerUnit - 1);
  const float t = at - static_cast<float>(i);
  Values result;
  for (std::size_t k = 0; k < 3; ++k) {
    result.phi[k] = kTable[i].phi[k] + t * (kTable[i + 1].phi[k] - kTable[i].phi[k]);
  }
  for (std::size_t k = 0; k < 4; ++k) {
    result.lambda[k] = kTable[i].lambda[k] + t * (kTable[i + 1].lambda[k] - kTable[i].lambda[k]);
  }
  return result;
}

}  // namespace prefilter::d4
