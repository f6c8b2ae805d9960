// SPDX-License-Identifier: GPL-3.0-or-later

// FreeType's smooth rasterizer, by spans of 8-bit gray. It is made for one letter at a time: its
// pool of cells is small, and an outline has at most 32767 points. So each shape is an outline, and
// spans are added.
#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "bench/shapes/rasterizers.h"

namespace prefilter::bench {
namespace {

constexpr std::size_t kMostPoints = std::numeric_limits<short>::max();

struct Shape {
  std::vector<FT_Vector> points;
  std::vector<char> tags;
  std::vector<short> ends;

  FT_Outline outline() {
    FT_Outline found{};
    found.n_contours = static_cast<short>(ends.size());
    found.n_points = static_cast<short>(points.size());
    found.points = points.data();
    found.tags = tags.data();
    found.contours = ends.data();
    return found;
  }
};

std::size_t longest_contour(const Path& path) {
  std::size_t longest = 0, length = 0;
  for (const Verb verb : path.verbs) {
    length = verb == Verb::kMove ? 1 : length + point_count(verb);
    longest = std::max(longest, length);
  }
  return longest;
}

class FreetypeDrawing final : public Drawing {
 public:
  explicit FreetypeDrawing(const Pattern& pattern)
      : pattern_(pattern), pixels_(static_cast<std::size_t>(pattern.width) * pattern.height) {
    if (FT_Init_FreeType(&library_) != 0) throw std::runtime_error("FreeType does not start");
    build();
  }
  ~FreetypeDrawing() override { FT_Done_FreeType(library_); }
  FreetypeDrawing(const FreetypeDrawing&) = delete;
  FreetypeDrawing& operator=(const FreetypeDrawing&) = delete;

  void build() override {
    shapes_.clear();
    const double* p = pattern_.path.points.data();
    Shape shape;
    int contours = 0;
    for (const Verb verb : pattern_.path.verbs) {
      const int count = point_count(verb);
      for (int point = 0; point < count; ++point, p += 2) {
        shape.points.push_back({std::lround(p[0] * 64), std::lround(p[1] * 64)});
        const bool on = point + 1 == count;
        shape.tags.push_back(on                     ? FT_CURVE_TAG_ON
                             : verb == Verb::kCubic ? FT_CURVE_TAG_CUBIC
                                                    : FT_CURVE_TAG_CONIC);
      }
      if (verb != Verb::kClose) continue;
      shape.ends.push_back(static_cast<short>(shape.points.size() - 1));
      if (++contours % pattern_.contours_per_shape == 0) {
        shapes_.push_back(std::move(shape));
        shape = {};
      }
    }
  }

  void clear() override { std::fill(pixels_.begin(), pixels_.end(), std::uint8_t{0}); }

  void draw() override {
    FT_Raster_Params parameters{};
    parameters.flags = FT_RASTER_FLAG_AA | FT_RASTER_FLAG_DIRECT | FT_RASTER_FLAG_CLIP;
    parameters.gray_spans = write_spans;
    parameters.user = this;
    parameters.clip_box = {0, 0, pattern_.width, pattern_.height};
    for (Shape& shape : shapes_) {
      FT_Outline outline = shape.outline();
      if (FT_Outline_Render(library_, &outline, &parameters) != 0) {
        throw std::runtime_error("FreeType cannot draw " + pattern_.name);
      }
    }
  }

  std::vector<float> coverage() const override { return from_bytes(pixels_); }

 private:
  static void write_spans(int y, int count, const FT_Span* spans, void* user) {
    auto& drawing = *static_cast<FreetypeDrawing*>(user);
    std::uint8_t* row =
        drawing.pixels_.data() + static_cast<std::size_t>(y) * drawing.pattern_.width;
    for (const FT_Span* span = spans; span != spans + count; ++span) {
      std::uint8_t* pixels = row + span->x;
      if (span->coverage == 255) {
        std::memset(pixels, 255, span->len);
        continue;
      }
      for (int pixel = 0; pixel < span->len; ++pixel) {
        pixels[pixel] = static_cast<std::uint8_t>(std::min(255, pixels[pixel] + span->coverage));
      }
    }
  }

  const Pattern& pattern_;
  std::vector<std::uint8_t> pixels_;
  FT_Library library_ = nullptr;
  std::vector<Shape> shapes_;
};

}  // namespace

Rasterizer freetype_rasterizer() {
  return {"FreeType", false, [](const Pattern& pattern, double) -> std::unique_ptr<Drawing> {
            if (longest_contour(pattern.path) > kMostPoints) return nullptr;
            return std::make_unique<FreetypeDrawing>(pattern);
          }};
}

}  // namespace prefilter::bench
