// Prefilter's own rasterizer, into floats.
#include <algorithm>
#include <span>

#include "bench/shapes/rasterizers.h"
#include "prefilter/raster/rasterize.h"

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

class OurDrawing final : public Drawing {
 public:
  OurDrawing(const Pattern& pattern, const std::string& filter, RasterMethod method)
      : pattern_(pattern), shapes_(1) {
    options_.width = pattern.width;
    options_.height = pattern.height;
    options_.filter = filter;
    options_.method = method;
    options_.threads = 1;
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

Rasterizer rasterizer(const std::string& name, const std::string& filter, RasterMethod method) {
  return {name, false, [filter, method](const Pattern& pattern, double) {
            return std::make_unique<OurDrawing>(pattern, filter, method);
          }};
}

}  // namespace

Rasterizer our_rasterizer() { return rasterizer("Prefilter", "box", RasterMethod::kScanline); }

std::vector<float> our_sum(const Pattern& pattern) {
  RasterOptions options;
  options.width = pattern.width;
  options.height = pattern.height;
  std::vector<Shape> shapes;
  for (const Path& path : contours(pattern.path)) shapes.push_back({outline_of(path), {}, {}});
  return rasterize(shapes, options).data;
}

std::vector<Rasterizer> our_rasterizers() {
  std::vector<Rasterizer> all;
  for (const char* filter : {"box", "tent", "bspline2", "mitchell", "lanczos2", "lanczos3",
                             "radial2", "radial3", "gaussian"}) {
    all.push_back(rasterizer(filter, filter, RasterMethod::kScanline));
  }
  all.push_back(rasterizer("wavelet", "box", RasterMethod::kWavelet));
  return all;
}

}  // namespace prefilter::bench
