// SPDX-License-Identifier: GPL-3.0-or-later

// Solves monotone polynomials for many values.
#pragma once

#include <algorithm>
#include <array>

#include "prefilter/base/double_pair.h"

namespace prefilter {

/// Coefficients of a cubic, by powers; 0 for the last one of a quadratic.
using CubicPowers = std::array<double, 4>;

/// Largest residual of a root.
inline constexpr double kMaxResidual = 3e-5;

/// Roots in [0, 1] of a polynomial that is monotone there.
template <bool kIsCubic>
class MonotoneRoots {
 public:
  struct Roots {
    DoublePair s;
    DoublePair miss;  // residual: the polynomial at s minus the value, at most kMaxResidual
  };

  explicit MonotoneRoots(const CubicPowers& p)
      : p_(p), p0_(pair_of(p[0])), p1_(pair_of(p[1])), p2_(pair_of(p[2])), p3_(pair_of(p[3])) {
    const double rise = p[1] + p[2] + p[3];
    const double scale = 1.0 / rise;
    // Slopes at both ends, scaled to a total rise of 1; clamped to [0, 4], the range for monotone
    // cubics. 0 if the polynomial is constant.
    const auto slope = [&](double sum) { return std::min(std::max(0.0, sum * scale), 4.0); };
    const double first_slope = slope(p[1]);
    const double last_slope = slope(p[1] + 2.0 * p[2] + 3.0 * p[3]);
    rise_ = pair_of(rise);
    scale_ = pair_of(scale);
    first_slope_ = pair_of(first_slope);
    bend_ = pair_of(first_slope + last_slope - 2.0);
  }

  /// Returns the nearest end for values beyond those at the ends.
  Roots operator()(DoublePair values) const {
    // Initial guess: the rational function with the same values and slopes at both ends, which is
    // exact for quadratics.
    const DoublePair zero{};
    const DoublePair one = pair_of(1.0);
    const DoublePair v = higher(lower((values - p0_) * scale_, one), zero);
    const DoublePair b = kIsCubic ? first_slope_ - bend_ * v : first_slope_;
    const DoublePair root = sqrt(higher(b * b + 4.0 * (v - b * v), zero));
    DoublePair s = lower((v + v) / (b + root + kTiny), one);
    values = p0_ + v * rise_;
    DoublePair miss = value_at(s) - values;
    if constexpr (kIsCubic) {
      s = two_steps(s, miss, values);
      miss = value_at(s) - values;
      for (int step = 0; farther(miss, kMaxResidual) != 0; ++step) {
        // Each root must not depend on the other in the pair.
        const int far = farther(miss, kMaxResidual);
        const DoublePair next = two_steps(s, miss, values);
        for (int i = 0; i < 2; ++i) {
          if ((far >> i & 1) != 0) s[i] = step < kMaxRootSteps ? next[i] : bisect(values[i]);
        }
        miss = value_at(s) - values;
        if (step == kMaxRootSteps) break;
      }
    }
    return {s, miss};
  }

 private:
  static constexpr double kTiny = 1e-300;  // turns 0 / 0 into 0
  static constexpr int kMaxRootSteps = 6;

  DoublePair value_at(DoublePair s) const {
    // Estrin's scheme has a shorter dependency chain than Horner's.
    if constexpr (kIsCubic) return (p0_ + s * p1_) + (s * s) * (p2_ + s * p3_);
    return (p0_ + s * p1_) + (s * s) * p2_;
  }
  // A step of Halley's method, then one of Newton's with the slope extrapolated from the first.
  DoublePair two_steps(DoublePair s, DoublePair miss, DoublePair values) const {
    const DoublePair bend = 3.0 * p3_ * s;
    const DoublePair half_second = p2_ + bend;
    const DoublePair slope = p1_ + s * (p2_ + half_second);
    const DoublePair off = miss * half_second;
    const DoublePair inverse = 1.0 / (slope * slope - off + kTiny);
    const DoublePair over_slope = slope * inverse;
    s -= miss * over_slope;
    return inside(s - (value_at(s) - values) * (over_slope + over_slope * (off * inverse)));
  }
  static DoublePair inside(DoublePair s) { return higher(lower(s, pair_of(1.0)), DoublePair{}); }
  // Bisection, for the few cubics with a vanishing slope.
  double bisect(double value) const {
    double low = 0.0;
    double high = 1.0;
    for (int step = 0; step < 52; ++step) {
      const double s = 0.5 * (low + high);
      const double off = p_[0] + s * (p_[1] + s * (p_[2] + s * p_[3])) - value;
      (off * scale_[0] > 0.0 ? high : low) = s;
    }
    return 0.5 * (low + high);
  }

  const CubicPowers& p_;
  DoublePair p0_;
  DoublePair p1_;
  DoublePair p2_;
  DoublePair p3_;
  DoublePair rise_;
  DoublePair scale_;
  DoublePair first_slope_;
  DoublePair bend_;
};

}  // namespace prefilter
