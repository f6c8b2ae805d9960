// SPDX-License-Identifier: GPL-3.0-or-later

// How far the levels of a mipmap are from the image they stand for, over the surface (figure 7.7).
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/textures/reader.h"

namespace prefilter {

/// The root mean square, over the surface's area and the channels, of the difference between a
/// trilinear lookup of `levels` at each mip value and a bilinear lookup of `image`. Mip values
/// below 0 or past the last level read the nearest level, as a GPU does. Exact: from moments,
/// without sampling. With kSrgbAfter each bilinear lookup is of encoded texels and then decoded,
/// and the integrals are by quadrature in the cells of the image. Throws Error where a level's size
/// does not fit the image, or a mip value is not a number, and for what `mipmaps` refuses.
std::vector<double> mipmap_error(const std::vector<ImageView>& levels, const ImageView& image,
                                 const std::vector<const Surface*>& surfaces,
                                 const std::vector<double>& mip_values, WrapModes wrap,
                                 Reader reader, const Progress& progress, int threads);

}  // namespace prefilter
