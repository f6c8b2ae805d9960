// SPDX-License-Identifier: GPL-3.0-or-later

// Images moved by affine and projective maps.
#pragma once

#include <array>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"
#include "prefilter/sampling/sample_places.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

/// Row by row; carries (x, y, 1) of the result, in its pixels, to (x w, y w, w) of the image, in
/// its texels. Pixel i spans [i, i + 1).
using Homography = std::array<double, 9>;

/// Where the center of a pixel lies in an image, and how it is spread there.
struct PixelPlace {
  bool is_visible = false;  // w > 0, and everything finite
  TexturePlace coordinates{};
  TextureJacobian jacobian{};
};
PixelPlace pixel_place(const Homography& transform, int column, int row, int image_width,
                       int image_height);

struct ResampleOptions {
  enum class Method {
    kTable,
    kTrilinear,  // interpolation of the kernel's levels
    kExact,      // sample_exactly; with more than one probe sample_elliptically
  };
  Method method = Method::kTrilinear;
  const SamplingTable* table = nullptr;  // for kTable; its kernel is `kernel`
  const Kernel* kernel = find_kernel("lanczos2");
  // 1: the filter is round, and as wide as the larger singular value of the Jacobian. More: see
  // sample_anisotropically.
  int max_probes = 1;
  WrapModes wrap;
  // As for ResizeOptions. What the border leaves of an opaque image is less than opaque.
  bool premultiplied = false;
  int threads = 0;  // 0 = all processors
  Progress progress;
};

/// The image as it is seen through the transform, with width x height pixels of 1 to 2^20 along
/// each side. Pixels whose w is not above 0 are zero: they look beyond the horizon.
///
/// Throws Error where channels are not 1 to 4, the transform is not finite, a size or max_probes is
/// out of range, probes are to be exact and the kernel is not the Gaussian, memory does not hold
/// the result, or a texel is not finite or beyond 1e30; and, from the progress callback, when
/// cancelled.
Image resample(const ImageView& image, const Homography& transform, int width, int height,
               const ResampleOptions& options);

}  // namespace prefilter
