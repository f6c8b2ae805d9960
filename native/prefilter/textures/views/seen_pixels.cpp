// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/views/seen_pixels.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "prefilter/textures/views/seen_triangles.h"

namespace prefilter {
namespace {

constexpr float kMostMip = 30.0F;   // of what a pixel looks up: no image has as many levels
constexpr double kFarthest = 1e9;   // of u and v, so that floats hold them
constexpr double kElsewhere = 0.5;  // pixels from where the middle of a pixel says
// What pixels show of places that lookups do not know is mostly chance: errors there are large, and
// would decide alone. With a tenth both kinds of pixels gain.
constexpr float kTrustElsewhere = 0.1F;

// The maps of triangles, of which the last is asked for again and again.
class Maps {
 public:
  explicit Maps(const SeenTriangles& triangles) : triangles_(triangles) {}
  const ScreenMap& of(std::uint32_t triangle) {
    if (triangle != last_) {
      map_ = triangles_.map_of(triangle);
      last_ = triangle;
    }
    return map_;
  }

 private:
  const SeenTriangles& triangles_;
  std::uint32_t last_ = SeenTriangles::kNothing;
  ScreenMap map_;
};

// A frame of a view, row by row.
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

  /// Nothing where the surface does not cover it.
  std::optional<SeenPixel> pixel(int x, int y) {
    const std::uint32_t triangle =
        middles_[static_cast<std::size_t>(y - begin_) * static_cast<std::size_t>(view_.size) +
                 static_cast<std::size_t>(x)];
    if (triangle == SeenTriangles::kNothing) return std::nullopt;
    const ScreenMap middle = triangles_.map_of(triangle);
    SeenPixel pixel = looked_up(middle, x + 0.5, y + 0.5);
    if (!(pixel.mip <= kMostMip) || !look(x, y, middle, &pixel)) return std::nullopt;
    return pixel;
  }

 private:
  // Finds what is in front in a pixel, and how much of it is where the middle says; false where the
  // surface does not cover it.
  bool look(int x, int y, const ScreenMap& middle, SeenPixel* pixel) {
    const int n = view_.samples;
    const auto width = static_cast<std::size_t>(view_.size) * static_cast<std::size_t>(n);
    const double reach = kElsewhere * elementary::exp2(pixel->mip);
    Lanes sum{};
    int near = 0;
    for (int j = 0; j < n; ++j) {
      const std::size_t row = static_cast<std::size_t>((y - begin_) * n + j) * width;
      for (int i = 0; i < n; ++i) {
        const std::uint32_t triangle = samples_[row + static_cast<std::size_t>(x * n + i)];
        if (triangle == SeenTriangles::kNothing) return false;
        const ScreenMap& map = maps_.of(triangle);
        const double sx = x + (i + 0.5) / n;
        const double sy = y + (j + 0.5) / n;
        const double u = map.at[0] + sx * map.by_x[0] + sy * map.by_y[0];
        const double v = map.at[1] + sx * map.by_x[1] + sy * map.by_y[1];
        if (!std::isfinite(u) || !std::isfinite(v)) return false;
        sum += bilinear(sampled_, wrap_, u, v);
        const double off_u = u - middle.at[0] - sx * middle.by_x[0] - sy * middle.by_y[0];
        const double off_v = v - middle.at[1] - sx * middle.by_x[1] - sy * middle.by_y[1];
        if (std::max(std::abs(off_u) * image_.width, std::abs(off_v) * image_.height) < reach) {
          ++near;
        }
      }
    }
    pixel->shown = sum * (Lanes{} + 1.0F / static_cast<float>(n * n));
    if (near < n * n) pixel->trust = kTrustElsewhere;
    return true;
  }

  SeenPixel looked_up(const ScreenMap& map, double x, double y) const {
    SeenPixel pixel;
    for (std::size_t a = 0; a < 2; ++a) {
      double at = map.at[a] + x * map.by_x[a] + y * map.by_y[a];
      // So that floats tell texels of far tiles apart.
      if ((a == 0 ? wrap_.u : wrap_.v) == Wrap::kRepeat) at -= std::floor(at);
      pixel.uv[a] = static_cast<float>(std::clamp(at, -kFarthest, kFarthest));
    }
    const double side_x =
        elementary::hypot(map.by_x[0] * image_.width, map.by_x[1] * image_.height);
    const double side_y =
        elementary::hypot(map.by_y[0] * image_.width, map.by_y[1] * image_.height);
    const double longer = std::max(side_x, side_y);
    const double shorter = std::min(side_x, side_y);
    const auto& along = side_x > side_y ? map.by_x : map.by_y;
    pixel.along = {static_cast<float>(along[0]), static_cast<float>(along[1])};
    const double ratio = longer <= shorter * kMostLookups ? longer / shorter : kMostLookups;
    pixel.count = static_cast<std::uint8_t>(
        shorter > 0.0 ? std::clamp(std::ceil(ratio), 1.0, static_cast<double>(kMostLookups))
                      : kMostLookups);
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
  SeenTriangles triangles_;
  Maps maps_{triangles_};
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

SeenPixels seen_pixels(const View& view, int begin, int end, const std::vector<ImageView>& levels,
                       WrapModes wrap) {
  SeenPixels seen;
  seen.weight = view.weight;
  Frame first(view, levels, wrap, false);
  Frame second(view, levels, wrap, true);
  first.draw(begin, end);
  second.draw(begin, end);
  for (int y = begin; y < end; ++y) {
    for (int x = 0; x < view.size; ++x) {
      const std::optional<SeenPixel> before = first.pixel(x, y);
      std::optional<SeenPixel> after = second.pixel(x, y);
      if (before) seen.pixels.push_back(*before);
      if (!after) continue;
      after->is_second = before.has_value();
      seen.pixels.push_back(*after);
    }
  }
  return seen;
}

}  // namespace prefilter
