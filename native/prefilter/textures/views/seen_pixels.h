// SPDX-License-Identifier: GPL-3.0-or-later

// What pixels of views look up, and what they should show.
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

/// A pixel that the surface covers.
struct SeenPixel {
  std::array<float, 2> uv{};     // at its middle
  std::array<float, 2> along{};  // the longer one of its sides, in u and v
  float mip = 0.0F;              // the value of one lookup
  float row_mip = 0.0F;          // of each one of a row
  std::uint8_t count = 1;        // of these
  bool is_second = false;        // of the two frames, and the pixel before is the first
  float trust = 1.0F;            // how much it counts
  Lanes shown{};                 // what it should show
};

struct SeenPixels {
  double weight = 0.0;  // of each
  std::vector<SeenPixel> pixels;
};

/// The most lookups in a row.
inline constexpr int kMostLookups = 16;

/// Calls visit(texel, weight) for the four texels, counted row by row, between which a bilinear
/// lookup at (u, v) interpolates; fewer at a border.
template <typename Visit>
void for_bilinear(const ImageView& image, WrapModes wrap, double u, double v, const Visit& visit) {
  constexpr double kFarthest = 1e9;  // so that indices do not overflow
  const double x = std::clamp(u * image.width - 0.5, -kFarthest, kFarthest);
  const double y = std::clamp(v * image.height - 0.5, -kFarthest, kFarthest);
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

/// The value of an image at (u, v).
Lanes bilinear(const ImageView& image, WrapModes wrap, double u, double v);

/// Those in rows [begin, end) of both frames of a view that are covered fully. `levels` are those
/// to take what they should show from.
SeenPixels seen_pixels(const View& view, int begin, int end, const std::vector<ImageView>& levels,
                       WrapModes wrap);

}  // namespace prefilter
