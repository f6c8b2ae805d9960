// SPDX-License-Identifier: GPL-3.0-or-later

// Isotropic samples of a pyramid (section 6.2).
#pragma once

#include <span>

#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/sampling/pyramid.h"
#include "prefilter/sampling/sample_places.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

struct SampleOptions {
  WrapModes wrap;
  Run run;
};

/// Writes samples at coordinates (u, v), which span the image from 0 to 1, to `result`, with
/// interleaved channels. If `table` is nullptr, interpolates trilinearly; otherwise the levels must
/// have been filtered with the table's kernel.
///
/// A scale is the width of the filter's unit in texels of level 0, in [0, inf); scales below 1
/// count as 1. There is one per sample, or one for all.
///
/// Throws Error for an invalid pyramid or table, a coordinate that is not finite, a scale that is
/// negative or not finite, or if the numbers of coordinates, scales and results do not match; and,
/// from the progress callback, when cancelled.
void sample(const Pyramid& pyramid, const SamplingTable* table,
            std::span<const TexturePlace> coordinates, std::span<const double> scales,
            const SampleOptions& options, std::span<float> result);

}  // namespace prefilter
