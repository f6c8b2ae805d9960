// SPDX-License-Identifier: GPL-3.0-or-later

// Resampling of images under affine and projective maps.
#pragma once

#include <array>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"
#include "prefilter/sampling/sample_places.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

/// A row-major matrix that maps (x, y, 1) in pixels of the result to (x w, y w, w) in texels of the
/// image. Pixel i spans [i, i + 1).
using Homography = std::array<double, 9>;

/// The position of a pixel's center in an image, and the Jacobian there.
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
    kExact,      // sample_exactly, or sample_elliptically with more than one probe
  };
  Method method = Method::kTrilinear;
  const SamplingTable* table = nullptr;  // for kTable; its kernel must be `kernel`
  const Kernel* kernel = find_kernel("lanczos2");
  // 1: the filter is circular, with the larger singular value of the Jacobian as its width. Above
  // 1: see sample_anisotropically.
  int max_probes = 1;
  WrapModes wrap;
  // See ResizeOptions. The border wrap mode makes opaque images transparent at their edges.
  bool premultiplied = false;
  int threads = 0;  // 0 = all processors
  Run run;
};

/// The image transformed to width x height pixels, 1 to 2^20 along each side. Pixels beyond the
/// horizon, where w is not positive, are zero.
///
/// Throws Error if the channel count is not 1 to 4, the transform is not finite, a size or
/// max_probes is out of range, exact probes are requested for a kernel other than the Gaussian, the
/// result exceeds the memory, or a texel is not finite or beyond 1e30; and, from the progress
/// callback, when cancelled.
Image resample(const ImageView& image, const Homography& transform, int width, int height,
               const ResampleOptions& options);

}  // namespace prefilter
