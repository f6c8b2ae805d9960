// SPDX-License-Identifier: GPL-3.0-or-later

// Prefilter's own rasterizers.
#include <algorithm>
#include <span>

#include "bench/shapes/rasterizers.h"
#include "prefilter/shapes/raster/box_coverage.h"
#include "prefilter/shapes/rasterize.h"
#include "prefilter/shapes/resolve.h"

namespace prefilter::bench {
namespace {

Outline outline_of(const Path& path) {
  Outline outline;
  const double* p = path.points.data();
  for (const Verb verb : path.verbs) {
    const int count = point_count(verb);
    std::array<Point2, 3> points;
    for (int point = 0; point < count; ++point) points[point] = {p[2 * point], p[2 * point + 1]};
    switch (verb) {
      case Verb::kMove:
        outline.move_to(points[0]);
        break;
      case Verb::kLine:
        outline.line_to(points[0]);
        break;
      case Verb::kQuadratic:
      case Verb::kCubic:
        outline.curve_to(std::span<const Point2>(points.data(), count));
        break;
      case Verb::kClose:
        outline.close();
        break;
    }
    p += 2 * count;
  }
  return outline;
}

// Any filter, by `rasterize`, which makes an image of floats each time. Overlaps are not looked
// for.
class FilteredDrawing final : public Drawing {
 public:
  FilteredDrawing(const Pattern& pattern, const std::string& filter, RasterMethod method)
      : pattern_(pattern), shapes_(1) {
    options_.width = pattern.width;
    options_.height = pattern.height;
    options_.filter = filter;
    options_.method = method;
    options_.overlap = Overlap::kAdd;
    options_.run = Run(1);
    shapes_[0].winds_once = true;
    build();
  }

  void build() override { shapes_[0].outline = outline_of(pattern_.path); }

  void clear() override { image_ = {}; }

  void draw() override { image_ = rasterize(shapes_, options_); }

  std::vector<float> coverage() const override { return image_.data; }

 private:
  const Pattern& pattern_;
  std::vector<Shape> shapes_;
  RasterOptions options_;
  Image image_;
};

// The box filter, into bytes as the others.
class ByteDrawing final : public Drawing {
 public:
  ByteDrawing(const Pattern& pattern, bool resolves)
      : pattern_(pattern),
        resolves_(resolves),
        pixels_(static_cast<std::size_t>(pattern.width) * pattern.height) {
    build();
  }

  void build() override { outline_ = outline_of(pattern_.path); }

  void clear() override { std::fill(pixels_.begin(), pixels_.end(), std::uint8_t{0}); }

  void draw() override {
    const ByteRows rows{pixels_.data(), pattern_.width, pattern_.height, pattern_.width};
    if (resolves_) {
      rasterizer_.draw(resolve(outline_, FillRule::kNonzero), rows);
    } else {
      rasterizer_.draw(outline_, rows);
    }
  }

  std::vector<float> coverage() const override { return from_bytes(pixels_); }

 private:
  const Pattern& pattern_;
  bool resolves_;
  std::vector<std::uint8_t> pixels_;
  Outline outline_;
  BoxRasterizer rasterizer_;
};

Rasterizer byte_rasterizer(const std::string& name, bool resolves) {
  return {name, false, [resolves](const Pattern& pattern, double) {
            return std::make_unique<ByteDrawing>(pattern, resolves);
          }};
}

Rasterizer rasterizer(const std::string& name, const std::string& filter, RasterMethod method) {
  return {name, false, [filter, method](const Pattern& pattern, double) {
            return std::make_unique<FilteredDrawing>(pattern, filter, method);
          }};
}

}  // namespace

std::vector<Rasterizer> our_boxes() {
  return {byte_rasterizer("Prefilter", false),
          byte_rasterizer("Prefilter, overlaps looked for", true),
          rasterizer("Prefilter, floats", "box", RasterMethod::kScanline)};
}

std::vector<float> our_sum(const Pattern& pattern) {
  RasterOptions options;
  options.width = pattern.width;
  options.height = pattern.height;
  options.overlap = Overlap::kAdd;
  std::vector<Shape> shapes;
  for (const Path& path : contours(pattern.path)) shapes.push_back({outline_of(path), {}, {}});
  return rasterize(shapes, options).data;
}

std::vector<Rasterizer> our_filters() {
  std::vector<Rasterizer> all;
  for (const char* filter : {"box", "tent", "bspline2", "mitchell", "lanczos2", "lanczos3",
                             "radial2", "radial3", "gaussian"}) {
    all.push_back(rasterizer(filter, filter, RasterMethod::kScanline));
  }
  all.push_back(rasterizer("wavelet", "box", RasterMethod::kWavelet));
  return all;
}

}  // namespace prefilter::bench
