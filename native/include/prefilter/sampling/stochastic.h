// SPDX-License-Identifier: GPL-3.0-or-later

// Samples that read a single texel each, with the right expected value.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/sampling/pyramid.h"
#include "prefilter/sampling/sample.h"
#include "prefilter/sampling/sample_places.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

/// The filter whose texels are picked from.
struct TexelChoice {
  enum class Kind {
    kTable,
    kTrilinear,
    kBilinear,  // bilinear interpolation in the level nearest to the mip value
  };
  Kind kind = Kind::kTrilinear;
  const SamplingTable* table = nullptr;  // for kTable
};

/// Picks one texel per sample. A number in [0, 1) selects the texel at which the running sum of the
/// weights' magnitudes passes that share of their total. Its weight is the total with its own sign.
/// So texels are picked with probabilities proportional to their magnitudes, and the mean of weight
/// times texel over all numbers is the weighted sum.
///
/// Throws Error for an invalid pyramid or table, places that check_places rejects, and unless there
/// is one number in [0, 1) per sample; and, from the progress callback, when cancelled.
std::vector<WeightedTexel> pick_texels(const Pyramid& pyramid, const TexelChoice& choice,
                                       const SamplePlaces& places, std::span<const double> numbers,
                                       const SampleOptions& options);

/// The picked texels times their weights, in the layout of `sample`; zero for texels in the border.
void sample_stochastically(const Pyramid& pyramid, const TexelChoice& choice,
                           const SamplePlaces& places, std::span<const double> numbers,
                           const SampleOptions& options, std::span<float> result);

}  // namespace prefilter
