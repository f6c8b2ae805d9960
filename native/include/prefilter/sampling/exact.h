// SPDX-License-Identifier: GPL-3.0-or-later

// Samples by the filter itself: what tables approximate.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"
#include "prefilter/sampling/sample_places.h"

namespace prefilter {

struct ExactOptions {
  const Kernel* kernel = find_kernel("lanczos2");
  WrapModes wrap;
  int threads = 0;  // 0 = all processors
  Progress progress;
};

/// The kernel-weighted mean of the image around a place: kernel_taps along x and y, of a width of
/// `scale`, or 1 where that is less. `values` gets one for each channel, of which the image may
/// have any number.
void sample_exactly(const ImageView& image, const Kernel& kernel, WrapModes wrap,
                    const TexturePlace& place, double scale, float* values);

/// The same at many places: the channels of each, one after another. No texel is read twice for a
/// sample, however wide it is.
///
/// Throws Error where places are not what check_places asks for; and, from the progress callback,
/// when cancelled.
std::vector<float> sample_exactly(const ImageView& image, const SamplePlaces& places,
                                  const ExactOptions& options);

}  // namespace prefilter
