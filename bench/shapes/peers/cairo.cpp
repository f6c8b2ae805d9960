// SPDX-License-Identifier: GPL-3.0-or-later

// Cairo's image backend, an A8 surface.
#include <cairo.h>

#include "bench/shapes/rasterizers.h"

namespace prefilter::bench {
namespace {

class CairoDrawing final : public Drawing {
 public:
  CairoDrawing(const Pattern& pattern, double fineness)
      : pattern_(pattern),
        surface_(cairo_image_surface_create(CAIRO_FORMAT_A8, pattern.width, pattern.height),
                 cairo_surface_destroy),
        context_(cairo_create(surface_.get()), cairo_destroy) {
    cairo_set_source_rgba(context_.get(), 1.0, 1.0, 1.0, 1.0);
    cairo_set_tolerance(context_.get(), cairo_get_tolerance(context_.get()) / fineness);
    build();
  }

  void build() override {
    cairo_t* context = context_.get();
    cairo_new_path(context);
    const double* p = pattern_.path.points.data();
    double x = 0.0, y = 0.0;
    for (const Verb verb : pattern_.path.verbs) {
      switch (verb) {
        case Verb::kMove:
          cairo_move_to(context, p[0], p[1]);
          break;
        case Verb::kLine:
          cairo_line_to(context, p[0], p[1]);
          break;
        case Verb::kQuadratic:
          cairo_curve_to(context, (x + 2 * p[0]) / 3, (y + 2 * p[1]) / 3, (p[2] + 2 * p[0]) / 3,
                         (p[3] + 2 * p[1]) / 3, p[2], p[3]);
          break;
        case Verb::kCubic:
          cairo_curve_to(context, p[0], p[1], p[2], p[3], p[4], p[5]);
          break;
        case Verb::kClose:
          cairo_close_path(context);
          break;
      }
      p += 2 * point_count(verb);
      x = p[-2];
      y = p[-1];
    }
  }

  void clear() override {
    cairo_surface_flush(surface_.get());
    unsigned char* pixels = cairo_image_surface_get_data(surface_.get());
    std::fill_n(pixels, static_cast<std::size_t>(stride()) * pattern_.height, 0);
    cairo_surface_mark_dirty(surface_.get());
  }

  void draw() override {
    cairo_fill_preserve(context_.get());
    cairo_surface_flush(surface_.get());
  }

  std::vector<float> coverage() const override {
    std::vector<std::uint8_t> bytes;
    const unsigned char* pixels = cairo_image_surface_get_data(surface_.get());
    for (int row = 0; row < pattern_.height; ++row) {
      const unsigned char* begin = pixels + static_cast<std::size_t>(row) * stride();
      bytes.insert(bytes.end(), begin, begin + pattern_.width);
    }
    return from_bytes(bytes);
  }

 private:
  int stride() const { return cairo_image_surface_get_stride(surface_.get()); }

  const Pattern& pattern_;
  std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
  std::unique_ptr<cairo_t, void (*)(cairo_t*)> context_;
};

}  // namespace

Rasterizer cairo_rasterizer() {
  return {"Cairo", true, [](const Pattern& pattern, double fineness) {
            return std::make_unique<CairoDrawing>(pattern, fineness);
          }};
}

}  // namespace prefilter::bench
