// SPDX-License-Identifier: GPL-3.0-or-later

// Error of mipmap levels against the full image, measured over the surface (figure 7.7).
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/textures/reader.h"

namespace prefilter {

/// For each mip value: the root mean square, over the surface's area and the channels, of the
/// difference between a trilinear lookup of `levels` at that value and a bilinear lookup of
/// `image`. Mip values below 0 or past the last level read the nearest level, as a GPU does. The
/// result is exact, computed from moments without sampling. For kSrgbAfter each bilinear lookup
/// filters encoded texels and then decodes, and the integrals use a quadrature rule in the cells of
/// the image. Throws Error if a level's size does not fit the image, if a mip value is NaN, and for
/// everything that `mipmaps` refuses.
std::vector<double> mipmap_error(const std::vector<ImageView>& levels, const ImageView& image,
                                 const std::vector<const Surface*>& surfaces,
                                 const std::vector<double>& mip_values, WrapModes wrap,
                                 Reader reader, const Run& run);

}  // namespace prefilter
