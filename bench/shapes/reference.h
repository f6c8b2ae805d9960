// SPDX-License-Identifier: GPL-3.0-or-later

// Reference coverage by brute force in double precision, independent of our library.
#pragma once

#include <vector>

#include "bench/shapes/patterns.h"

namespace prefilter::bench {

/// The pattern's coverage of each pixel, with an error of about 1e-7: curves are followed to 1e-7
/// pixels.
std::vector<double> true_coverage(const Pattern& pattern);

struct Errors {
  double largest;
  double root_mean_square;  ///< Over the pixels that are neither empty nor full.
};

Errors errors(const std::vector<float>& coverage, const std::vector<double>& truth);

}  // namespace prefilter::bench
