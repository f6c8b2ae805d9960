// Whether numbers are numbers.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// True where no value of the image is infinite or not a number.
bool all_finite(const ImageView& image, const Progress& progress, int threads);

}  // namespace prefilter
