// SPDX-License-Identifier: GPL-3.0-or-later

// Blend2D, an A8 image, no worker threads: a call has drawn when it returns.
#include <blend2d/blend2d.h>

#include <stdexcept>

#include "bench/shapes/rasterizers.h"

namespace prefilter::bench {
namespace {

void check(BLResult result) {
  if (result != BL_SUCCESS) throw std::runtime_error("Blend2D: error " + std::to_string(result));
}

class Blend2dDrawing final : public Drawing {
 public:
  Blend2dDrawing(const Pattern& pattern, double fineness)
      : pattern_(pattern), image_(pattern.width, pattern.height, BL_FORMAT_A8) {
    check(context_.begin(image_));
    check(context_.set_fill_style(BLRgba32(0xFFFFFFFFu)));
    check(context_.set_fill_rule(BL_FILL_RULE_NON_ZERO));
    check(context_.set_flatten_tolerance(context_.approximation_options().flatten_tolerance /
                                         fineness));
    build();
  }

  void build() override {
    path_.clear();
    const double* p = pattern_.path.points.data();
    for (const Verb verb : pattern_.path.verbs) {
      switch (verb) {
        case Verb::kMove:
          path_.move_to(p[0], p[1]);
          break;
        case Verb::kLine:
          path_.line_to(p[0], p[1]);
          break;
        case Verb::kQuadratic:
          path_.quad_to(p[0], p[1], p[2], p[3]);
          break;
        case Verb::kCubic:
          path_.cubic_to(p[0], p[1], p[2], p[3], p[4], p[5]);
          break;
        case Verb::kClose:
          path_.close();
          break;
      }
      p += 2 * point_count(verb);
    }
  }

  void clear() override { check(context_.clear_all()); }

  void draw() override { check(context_.fill_path(path_)); }

  std::vector<float> coverage() const override {
    BLImageData data;
    check(image_.get_data(&data));
    std::vector<std::uint8_t> bytes;
    for (int row = 0; row < pattern_.height; ++row) {
      const auto* begin = static_cast<const std::uint8_t*>(data.pixel_data) + row * data.stride;
      bytes.insert(bytes.end(), begin, begin + pattern_.width);
    }
    return from_bytes(bytes);
  }

 private:
  const Pattern& pattern_;
  BLImage image_;
  BLContext context_;
  BLPath path_;
};

}  // namespace

Rasterizer blend2d_rasterizer() {
  return {"Blend2D", true, [](const Pattern& pattern, double fineness) {
            return std::make_unique<Blend2dDrawing>(pattern, fineness);
          }};
}

}  // namespace prefilter::bench
