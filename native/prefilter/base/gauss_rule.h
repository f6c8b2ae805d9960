// SPDX-License-Identifier: GPL-3.0-or-later

// Quadrature over an interval.
#pragma once

#include <array>
#include <numbers>

#include "prefilter/base/elementary.h"

namespace prefilter {

/// The Gauss rule of K points on [0, 1].
template <int K>
struct GaussRule {
  std::array<double, K> nodes;
  std::array<double, K> weights;
};

template <int K>
const GaussRule<K>& gauss_rule() {
  static const GaussRule<K> rule = [] {
    GaussRule<K> gauss{};
    for (int i = 0; i < K; ++i) {
      // Newton's method for a root of the Legendre polynomial, starting from Chebyshev's.
      double x = elementary::cos(std::numbers::pi * (i + 0.75) / (K + 0.5));
      double slope = 1.0;
      for (int step = 0; step < 20; ++step) {
        double before = 1.0;
        double value = x;
        for (int k = 2; k <= K; ++k) {
          const double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
          before = value;
          value = next;
        }
        slope = K * (x * value - before) / (x * x - 1.0);
        x -= value / slope;
      }
      gauss.nodes[i] = 0.5 - 0.5 * x;
      gauss.weights[i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
    return gauss;
  }();
  return rule;
}

}  // namespace prefilter
