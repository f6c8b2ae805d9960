// SPDX-License-Identifier: GPL-3.0-or-later

// Samples with the exact filter, which tables approximate.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"
#include "prefilter/sampling/sample_places.h"

namespace prefilter {

struct ExactOptions {
  const Kernel* kernel = find_kernel("lanczos2");
  WrapModes wrap;
  Run run;
};

/// Writes the kernel-weighted mean of the image around a place, one value per channel, to `values`:
/// kernel_taps along x and y, of a width of `scale`, or 1 if that is less. The image may have any
/// number of channels.
void sample_exactly(const ImageView& image, const Kernel& kernel, WrapModes wrap,
                    const TexturePlace& place, double scale, float* values);

/// The same at many places, with interleaved channels. Each sample reads a texel at most once,
/// however wide the filter is.
///
/// Throws Error for places that check_places rejects; and, from the progress callback, when
/// cancelled.
std::vector<float> sample_exactly(const ImageView& image, const SamplePlaces& places,
                                  const ExactOptions& options);

}  // namespace prefilter
