// SPDX-License-Identifier: GPL-3.0-or-later

// Samples of a single texel, right on average.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/sampling/pyramid.h"
#include "prefilter/sampling/sample.h"
#include "prefilter/sampling/sample_places.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

/// What texels are picked from.
struct TexelChoice {
  enum class Kind {
    kTable,
    kTrilinear,
    kBilinear,  // interpolation in the level next to the mip value
  };
  Kind kind = Kind::kTrilinear;
  const SamplingTable* table = nullptr;  // for kTable
};

/// One of the texels of each sample: for a number in [0, 1) the one at which the sum of the
/// magnitudes of the weights, from the first texel on, passes that share of them all. Its weight is
/// that sum with the sign of its own: texels are picked with a probability proportional to their
/// magnitude, and the mean of weight times texel over all numbers is the weighted sum.
///
/// Throws Error for a pyramid or a table that is none, places that check_places refuses, and where
/// there is not one number in [0, 1) for each sample; and, from the progress callback, when
/// cancelled.
std::vector<WeightedTexel> pick_texels(const Pyramid& pyramid, const TexelChoice& choice,
                                       const SamplePlaces& places, std::span<const double> numbers,
                                       const SampleOptions& options);

/// The texels so picked times their weights, as `sample` gives its results; zero for those outside
/// of the border.
void sample_stochastically(const Pyramid& pyramid, const TexelChoice& choice,
                           const SamplePlaces& places, std::span<const double> numbers,
                           const SampleOptions& options, std::span<float> result);

}  // namespace prefilter
