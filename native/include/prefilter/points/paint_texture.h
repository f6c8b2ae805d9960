// SPDX-License-Identifier: GPL-3.0-or-later

// The colors of points on the texture of a surface.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

struct PaintOptions {
  int width = 0;
  int height = 0;
  WrapModes wrap;
  /// How much smoothness counts, of what a point in each texel does: 0 to 1e6, and above 0.
  double smoothing = 0.05;
  /// Points that are farther from the surface do not count; none: all do.
  std::optional<double> reach;
  Progress progress;
  int threads = 0;
};

struct PaintedTexture {
  Image image;
  std::size_t points = 0;  // that counted
};

/// The texture whose bilinear lookups come nearest to the values of points, in the sum of squares,
/// each point's where the surface is nearest to it: least squares with the integral of the squared
/// gradient over the texels that the surface reads, times `smoothing`. That fills what no point is
/// near, and averages their noise. Values stay within the range of those of the points. All other
/// texels are filled from those around them.
///
/// Values are `channels` for each point, 1 to 4. Points that are not finite, or above 1e150, and
/// those with a value that is not finite or above 1e30 do not count. The same for any number of
/// threads. Throws Error for a side below 1, other numbers of values than of points times
/// channels, options out of range, or where no point counts; Error(kCancelled).
PaintedTexture paint_texture(const Surface& surface, std::span<const Vector3> points,
                             std::span<const float> values, int channels,
                             const PaintOptions& options);

}  // namespace prefilter
