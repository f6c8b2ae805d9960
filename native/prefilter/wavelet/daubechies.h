// SPDX-License-Identifier: GPL-3.0-or-later

// Daubechies' wavelet with four coefficients, D4 (section 4.4).
//
// phi(t) = sum of kLow[l] phi(2 t - l), supported on [0, 3]; psi by equation 3.2.
#pragma once

#include <array>

namespace prefilter::d4 {

/// Refinement coefficients of phi, for l from 0 to 3.
inline constexpr double kSqrt3 = 1.7320508075688772;
inline constexpr std::array<double, 4> kLow = {(1.0 + kSqrt3) / 4.0, (3.0 + kSqrt3) / 4.0,
                                               (3.0 - kSqrt3) / 4.0, (1.0 - kSqrt3) / 4.0};
/// Refinement coefficients of psi, (-1)^l kLow[1 - l], for l from -2 to 1.
inline constexpr std::array<double, 4> kHigh = {kLow[3], -kLow[2], kLow[1], -kLow[0]};

/// Values of phi and of lambda(t), the integral of phi from t - 1 to t, at f, f + 1, ... for a
/// fraction f.
struct Values {
  std::array<float, 3> phi;
  std::array<float, 4> lambda;
};

/// The values for f from 0 to 1: exact at multiples of 1/64, linearly interpolated in between.
Values values_at(float f);

}  // namespace prefilter::d4
