// SPDX-License-Identifier: GPL-3.0-or-later

// Anti-Grain Geometry, gray of 8 bits, with either of its scanlines: unpacked, as its examples
// have it, a coverage for each pixel; packed, one for a whole run of full pixels.
#include <agg_conv_curve.h>
#include <agg_path_storage.h>
#include <agg_pixfmt_gray.h>
#include <agg_rasterizer_scanline_aa.h>
#include <agg_renderer_base.h>
#include <agg_renderer_scanline.h>
#include <agg_rendering_buffer.h>
#include <agg_scanline_p.h>
#include <agg_scanline_u.h>

#include <algorithm>

#include "bench/shapes/rasterizers.h"

namespace prefilter::bench {
namespace {

template <typename Scanline>
class AggDrawing final : public Drawing {
 public:
  AggDrawing(const Pattern& pattern, double fineness)
      : pattern_(pattern),
        pixels_(static_cast<std::size_t>(pattern.width) * pattern.height),
        buffer_(pixels_.data(), pattern.width, pattern.height, pattern.width),
        format_(buffer_),
        base_(format_),
        renderer_(base_) {
    renderer_.color(agg::gray8(255));
    rasterizer_.clip_box(0, 0, pattern.width, pattern.height);
    curves_.approximation_scale(fineness);
    build();
  }

  void build() override {
    storage_.remove_all();
    const double* p = pattern_.path.points.data();
    for (const Verb verb : pattern_.path.verbs) {
      switch (verb) {
        case Verb::kMove:
          storage_.move_to(p[0], p[1]);
          break;
        case Verb::kLine:
          storage_.line_to(p[0], p[1]);
          break;
        case Verb::kQuadratic:
          storage_.curve3(p[0], p[1], p[2], p[3]);
          break;
        case Verb::kCubic:
          storage_.curve4(p[0], p[1], p[2], p[3], p[4], p[5]);
          break;
        case Verb::kClose:
          storage_.close_polygon();
          break;
      }
      p += 2 * point_count(verb);
    }
  }

  void clear() override { std::fill(pixels_.begin(), pixels_.end(), agg::int8u{0}); }

  void draw() override {
    rasterizer_.reset();
    rasterizer_.add_path(curves_);
    agg::render_scanlines(rasterizer_, scanline_, renderer_);
  }

  std::vector<float> coverage() const override { return from_bytes(pixels_); }

 private:
  using Base = agg::renderer_base<agg::pixfmt_gray8>;

  const Pattern& pattern_;
  std::vector<agg::int8u> pixels_;
  agg::rendering_buffer buffer_;
  agg::pixfmt_gray8 format_;
  Base base_;
  agg::renderer_scanline_aa_solid<Base> renderer_;
  agg::path_storage storage_;
  agg::conv_curve<agg::path_storage> curves_{storage_};
  agg::rasterizer_scanline_aa<> rasterizer_;
  Scanline scanline_;
};

template <typename Scanline>
Rasterizer rasterizer(const std::string& name) {
  return {name, true, [](const Pattern& pattern, double fineness) {
            return std::make_unique<AggDrawing<Scanline>>(pattern, fineness);
          }};
}

}  // namespace

Rasterizer agg_rasterizer() { return rasterizer<agg::scanline_u8>("AGG"); }
Rasterizer packed_agg_rasterizer() { return rasterizer<agg::scanline_p8>("AGG packed"); }

}  // namespace prefilter::bench
