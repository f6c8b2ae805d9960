// SPDX-License-Identifier: GPL-3.0-or-later

// Projects colors of points onto the texture of a surface.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

struct PaintOptions {
  int width = 0;
  int height = 0;
  WrapModes wrap;
  /// Weight of smoothness relative to one point per texel; above 0 and up to 1e6.
  double smoothing = 0.05;
  /// Points farther from the surface are ignored; by default all points are used.
  std::optional<double> reach;
  Run run;
};

struct PaintedTexture {
  Image image;
  std::size_t points = 0;  // number of points used
};

/// The texture whose bilinear lookups at the points' nearest positions on the surface match the
/// points' values best: least squares, plus `smoothing` times the integral of the squared gradient
/// over the texels that the surface reads. Smoothing fills texels without points and averages
/// noise. Values stay within the range of the points' values. All other texels are filled from
/// their surroundings.
///
/// `values` has `channels` values per point, 1 to 4. Points that are not finite or above 1e150, and
/// points with a value that is not finite or above 1e30, are ignored. The result is the same for
/// any number of threads. Throws Error for a side below 1, a number of values other than points
/// times channels, options out of range, or if no point is used; Error(kCancelled).
PaintedTexture paint_texture(const Surface& surface, std::span<const Vector3> points,
                             std::span<const float> values, int channels,
                             const PaintOptions& options);

}  // namespace prefilter
