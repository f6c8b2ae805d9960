// SPDX-License-Identifier: GPL-3.0-or-later

// Samples with elliptical Gaussians, the exact anisotropic filter.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/sampling/sample_places.h"

namespace prefilter {

struct EllipticalOptions {
  WrapModes wrap;
  Run run;
};

/// Means of the texels of an image, with any number of channels, weighted by the Gaussian exp(-pi
/// |p|^2) in pixel coordinates p. In texels the Jacobian J maps it to exp(-pi d^T (J J^T)^-1 d) at
/// the distance vector d, with the singular values of J clamped as in footprint_of. The Gaussian is
/// truncated at |p| = 2 sqrt(2), where it is 1e-11; the corners of the separable filter are as far
/// away.
///
/// Throws Error for places that check_coordinates or check_jacobians rejects; and, from the
/// progress callback, when cancelled.
std::vector<float> sample_elliptically(const ImageView& image,
                                       std::span<const TexturePlace> coordinates,
                                       std::span<const TextureJacobian> jacobians,
                                       const EllipticalOptions& options);

}  // namespace prefilter
