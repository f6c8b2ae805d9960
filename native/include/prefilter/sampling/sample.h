// SPDX-License-Identifier: GPL-3.0-or-later

// Isotropic samples of a pyramid (section 6.2).
#pragma once

#include <span>

#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/sampling/pyramid.h"
#include "prefilter/sampling/sample_places.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

struct SampleOptions {
  WrapModes wrap;
  int threads = 0;  // 0 = all processors
  Progress progress;
};

/// Samples at coordinates (u, v), with the image from 0 to 1 along both, into `result`: the
/// channels of one sample after those of another. `table` may be nullptr: trilinear interpolation.
/// Otherwise the levels must have been filtered by the table's kernel.
///
/// A scale is the width of the filter's unit in texels of level 0, in [0, inf); below 1 it counts
/// as 1. There is one for each sample, or one for all.
///
/// Throws Error for a pyramid or a table that is none, a coordinate that is not finite, a scale
/// that is negative or not finite, or numbers of coordinates, scales and results that disagree;
/// and, from the progress callback, when cancelled.
void sample(const Pyramid& pyramid, const SamplingTable* table,
            std::span<const TexturePlace> coordinates, std::span<const double> scales,
            const SampleOptions& options, std::span<float> result);

}  // namespace prefilter
