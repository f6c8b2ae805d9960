// SPDX-License-Identifier: GPL-3.0-or-later

// Pixels of rendered views: their texture lookups and target colors.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/lanes.h"
#include "prefilter/base/wrap.h"
#include "prefilter/textures/views/view_plan.h"

namespace prefilter {

/// A pixel that the surface covers fully.
struct ViewPixel {
  std::array<float, 2> uv{};     // at the center
  std::array<float, 2> along{};  // longer axis of the footprint, in u and v
  float mip = 0.0F;              // of a single trilinear lookup
  float row_mip = 0.0F;          // of each of the `count` lookups of an anisotropic one
  std::uint8_t count = 1;
  bool is_second = false;  // of the second frame; the entry before is its first frame's
  float trust = 1.0F;      // weight, 0 to 1
  Lanes target{};          // the color that it should show
};

struct ViewPixels {
  double weight = 0.0;  // of each pixel
  std::vector<ViewPixel> pixels;
};

/// Most lookups in an anisotropic one.
inline constexpr int kMaxLookups = 16;

/// Calls visit(texel, weight) for the four texels, by row-major index, between which a bilinear
/// lookup at (u, v) interpolates; fewer at a border.
template <typename Visit>
void for_bilinear(const ImageView& image, WrapModes wrap, double u, double v, const Visit& visit) {
  constexpr double kMaxPosition = 1e9;  // so that indices do not overflow
  const double x = std::clamp(u * image.width - 0.5, -kMaxPosition, kMaxPosition);
  const double y = std::clamp(v * image.height - 0.5, -kMaxPosition, kMaxPosition);
  const double left = std::floor(x);
  const double low = std::floor(y);
  const auto in_x = static_cast<float>(x - left);
  const auto in_y = static_cast<float>(y - low);
  for (int k = 0; k < 4; ++k) {
    const int i = wrap_index(static_cast<int>(left) + k % 2, image.width, wrap.u);
    const int j = wrap_index(static_cast<int>(low) + k / 2, image.height, wrap.v);
    if (i < 0 || j < 0) continue;
    visit(static_cast<std::size_t>(j) * static_cast<std::size_t>(image.width) +
              static_cast<std::size_t>(i),
          (k % 2 == 0 ? 1.0F - in_x : in_x) * (k / 2 == 0 ? 1.0F - in_y : in_y));
  }
}

/// The bilinear lookup of an image at (u, v).
Lanes bilinear(const ImageView& image, WrapModes wrap, double u, double v);

/// The fully covered pixels in rows [begin, end) of both frames of a view. The targets come from
/// `levels`.
ViewPixels view_pixels(const View& view, int begin, int end, const std::vector<ImageView>& levels,
                       WrapModes wrap);

}  // namespace prefilter
