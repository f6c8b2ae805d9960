// SPDX-License-Identifier: GPL-3.0-or-later

// Coverage that errors are counted against: brute force in double precision, our library not in it.
#pragma once

#include <vector>

#include "bench/shapes/patterns.h"

namespace prefilter::bench {

/// How much of each pixel the pattern covers. Curves are followed to 1e-7 pixels, so that no pixel
/// is off by more than about that.
std::vector<double> true_coverage(const Pattern& pattern);

struct Errors {
  double largest;
  double root_mean_square;  ///< Over the pixels that are neither empty nor full.
};

Errors errors(const std::vector<float>& coverage, const std::vector<double>& truth);

}  // namespace prefilter::bench
