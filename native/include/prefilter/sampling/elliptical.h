// SPDX-License-Identifier: GPL-3.0-or-later

// Samples by elliptical Gaussians, the exact anisotropic filter.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/sampling/sample_places.h"

namespace prefilter {

struct EllipticalOptions {
  WrapModes wrap;
  int threads = 0;  // 0 = all processors
  Progress progress;
};

/// The mean of the texels of the image, of any number of channels, weighted by the Gaussian
/// exp(-pi |p|^2) of a pixel p carried into it by the Jacobian: exp(-pi d^T (J J^T)^-1 d) at a
/// distance of d texels, the singular values of J clamped as footprint_of does. It ends where |p|
/// is 2 sqrt(2), and the Gaussian 1e-11: as far off as the corners of the separable one.
///
/// Throws Error where places are not what check_coordinates and check_jacobians ask for; and, from
/// the progress callback, when cancelled.
std::vector<float> sample_elliptically(const ImageView& image,
                                       std::span<const TexturePlace> coordinates,
                                       std::span<const TextureJacobian> jacobians,
                                       const EllipticalOptions& options);

}  // namespace prefilter
