// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/views/view_pixels.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "prefilter/textures/views/triangle_buffer.h"

namespace prefilter {
namespace {

constexpr float kMaxPixelMip = 30.0F;    // clamp; no image has as many levels
constexpr double kMaxTexcoord = 1e9;     // clamp of u and v, so that floats hold them
constexpr double kMaxTexcoordGap = 0.5;  // pixels, from the position extrapolated from the center
// Weight of pixels that show parts of the texture their lookup does not read. Their errors are
// large and mostly chance, and would dominate the fit at full weight; at a tenth, both kinds of
// pixels gain.
constexpr float kMixedPixelTrust = 0.1F;

// Caches the last map, as neighboring samples mostly show the same triangle.
class ScreenMapCache {
 public:
  explicit ScreenMapCache(const TriangleBuffer& triangles) : triangles_(triangles) {}
  const ScreenMap& of(std::uint32_t triangle) {
    if (triangle != last_) {
      map_ = triangles_.map_of(triangle);
      last_ = triangle;
    }
    return map_;
  }

 private:
  const TriangleBuffer& triangles_;
  std::uint32_t last_ = TriangleBuffer::kNothing;
  ScreenMap map_;
};

// One frame of a view, drawn in bands of rows.
class Frame {
 public:
  Frame(const View& view, const std::vector<ImageView>& levels, WrapModes wrap, bool is_second)
      : view_(view),
        image_(levels[0]),
        sampled_(levels[static_cast<std::size_t>(view.sampled_level)]),
        wrap_(wrap),
        triangles_(view, is_second) {}

  void draw(int begin, int end) {
    begin_ = begin;
    triangles_.draw(begin, end, view_.samples, &samples_);
    triangles_.draw(begin, end, 1, &middles_);
  }

  /// Nothing unless the surface covers the whole pixel.
  std::optional<ViewPixel> pixel(int x, int y) {
    const std::uint32_t triangle =
        middles_[static_cast<std::size_t>(y - begin_) * static_cast<std::size_t>(view_.size) +
                 static_cast<std::size_t>(x)];
    if (triangle == TriangleBuffer::kNothing) return std::nullopt;
    const ScreenMap middle = triangles_.map_of(triangle);
    ViewPixel pixel = lookup_at(middle, x + 0.5, y + 0.5);
    if (!(pixel.mip <= kMaxPixelMip) || !sample_color(x, y, middle, &pixel)) return std::nullopt;
    return pixel;
  }

 private:
  // Averages the surface color over the samples of a pixel, and lowers its trust if some samples
  // are far from the texture position extrapolated from its center. Returns false unless the
  // surface covers all samples.
  bool sample_color(int x, int y, const ScreenMap& middle, ViewPixel* pixel) {
    const int n = view_.samples;
    const auto width = static_cast<std::size_t>(view_.size) * static_cast<std::size_t>(n);
    const double max_gap = kMaxTexcoordGap * elementary::exp2(pixel->mip);
    Lanes sum{};
    int near_count = 0;
    for (int j = 0; j < n; ++j) {
      const std::size_t row = static_cast<std::size_t>((y - begin_) * n + j) * width;
      for (int i = 0; i < n; ++i) {
        const std::uint32_t triangle = samples_[row + static_cast<std::size_t>(x * n + i)];
        if (triangle == TriangleBuffer::kNothing) return false;
        const ScreenMap& map = maps_.of(triangle);
        const double sx = x + (i + 0.5) / n;
        const double sy = y + (j + 0.5) / n;
        const double u = map.at[0] + sx * map.by_x[0] + sy * map.by_y[0];
        const double v = map.at[1] + sx * map.by_x[1] + sy * map.by_y[1];
        if (!std::isfinite(u) || !std::isfinite(v)) return false;
        sum += bilinear(sampled_, wrap_, u, v);
        const double off_u = u - middle.at[0] - sx * middle.by_x[0] - sy * middle.by_y[0];
        const double off_v = v - middle.at[1] - sx * middle.by_x[1] - sy * middle.by_y[1];
        if (std::max(std::abs(off_u) * image_.width, std::abs(off_v) * image_.height) < max_gap) {
          ++near_count;
        }
      }
    }
    pixel->target = sum * (Lanes{} + 1.0F / static_cast<float>(n * n));
    if (near_count < n * n) pixel->trust = kMixedPixelTrust;
    return true;
  }

  ViewPixel lookup_at(const ScreenMap& map, double x, double y) const {
    ViewPixel pixel;
    for (std::size_t a = 0; a < 2; ++a) {
      double at = map.at[a] + x * map.by_x[a] + y * map.by_y[a];
      // Wrapped first, as floats lack the precision for coordinates of far tiles.
      if ((a == 0 ? wrap_.u : wrap_.v) == Wrap::kRepeat) at -= std::floor(at);
      pixel.uv[a] = static_cast<float>(std::clamp(at, -kMaxTexcoord, kMaxTexcoord));
    }
    const double side_x =
        elementary::hypot(map.by_x[0] * image_.width, map.by_x[1] * image_.height);
    const double side_y =
        elementary::hypot(map.by_y[0] * image_.width, map.by_y[1] * image_.height);
    const double longer = std::max(side_x, side_y);
    const double shorter = std::min(side_x, side_y);
    const auto& along = side_x > side_y ? map.by_x : map.by_y;
    pixel.along = {static_cast<float>(along[0]), static_cast<float>(along[1])};
    const double ratio = longer <= shorter * kMaxLookups ? longer / shorter : kMaxLookups;
    pixel.count = static_cast<std::uint8_t>(
        shorter > 0.0 ? std::clamp(std::ceil(ratio), 1.0, static_cast<double>(kMaxLookups))
                      : kMaxLookups);
    const auto mip_of = [](double side) {
      return side <= 1.0 ? 0.0F : static_cast<float>(elementary::log2(side));
    };
    pixel.mip = mip_of(longer);
    pixel.row_mip = mip_of(longer / pixel.count);
    return pixel;
  }

  const View& view_;
  const ImageView& image_;
  const ImageView& sampled_;
  WrapModes wrap_;
  TriangleBuffer triangles_;
  ScreenMapCache maps_{triangles_};
  int begin_ = 0;
  std::vector<std::uint32_t> samples_;
  std::vector<std::uint32_t> middles_;
};

}  // namespace

Lanes bilinear(const ImageView& image, WrapModes wrap, double u, double v) {
  Lanes sum{};
  for_bilinear(image, wrap, u, v, [&](std::size_t texel, float weight) {
    const float* const values = image.data + texel * static_cast<std::size_t>(image.channels);
    for (int c = 0; c < image.channels; ++c) sum[c] += weight * values[c];
  });
  return sum;
}

ViewPixels view_pixels(const View& view, int begin, int end, const std::vector<ImageView>& levels,
                       WrapModes wrap) {
  ViewPixels seen;
  seen.weight = view.weight;
  Frame first(view, levels, wrap, false);
  Frame second(view, levels, wrap, true);
  first.draw(begin, end);
  second.draw(begin, end);
  for (int y = begin; y < end; ++y) {
    for (int x = 0; x < view.size; ++x) {
      const std::optional<ViewPixel> before = first.pixel(x, y);
      std::optional<ViewPixel> after = second.pixel(x, y);
      if (before) seen.pixels.push_back(*before);
      if (!after) continue;
      after->is_second = before.has_value();
      seen.pixels.push_back(*after);
    }
  }
  return seen;
}

}  // namespace prefilter
