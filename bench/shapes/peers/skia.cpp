// SPDX-License-Identifier: GPL-3.0-or-later

// Skia through skia-python, in a Python inside of this process: an A8 surface. A call is one
// drawPath; Python adds less than a microsecond. PYTHONPATH says where skia is.
#include <pybind11/embed.h>

#include "bench/shapes/rasterizers.h"

namespace prefilter::bench {
namespace {

namespace py = pybind11;

py::module_ skia() {
  static py::scoped_interpreter interpreter;
  return py::module_::import("skia");
}

class SkiaDrawing final : public Drawing {
 public:
  explicit SkiaDrawing(const Pattern& pattern)
      : pattern_(pattern),
        pixels_(static_cast<std::size_t>(pattern.width) * pattern.height),
        skia_(skia()) {
    const auto size = static_cast<py::ssize_t>(pixels_.size());
    surface_ = skia_.attr("Surface").attr("MakeRasterDirect")(
        skia_.attr("ImageInfo").attr("MakeA8")(pattern.width, pattern.height),
        py::memoryview::from_memory(pixels_.data(), size), pattern.width);
    canvas_ = surface_.attr("getCanvas")();
    draw_path_ = canvas_.attr("drawPath");
    paint_ = skia_.attr("Paint")();
    paint_.attr("setAntiAlias")(true);
    build();
  }

  void build() override {
    path_ = skia_.attr("Path")();
    const py::object move = path_.attr("moveTo"), line = path_.attr("lineTo"),
                     quad = path_.attr("quadTo"), cubic = path_.attr("cubicTo"),
                     close = path_.attr("close");
    const double* p = pattern_.path.points.data();
    for (const Verb verb : pattern_.path.verbs) {
      switch (verb) {
        case Verb::kMove:
          move(p[0], p[1]);
          break;
        case Verb::kLine:
          line(p[0], p[1]);
          break;
        case Verb::kQuadratic:
          quad(p[0], p[1], p[2], p[3]);
          break;
        case Verb::kCubic:
          cubic(p[0], p[1], p[2], p[3], p[4], p[5]);
          break;
        case Verb::kClose:
          close();
          break;
      }
      p += 2 * point_count(verb);
    }
  }

  void clear() override { std::fill(pixels_.begin(), pixels_.end(), std::uint8_t{0}); }

  void draw() override { draw_path_(path_, paint_); }

  std::vector<float> coverage() const override { return from_bytes(pixels_); }

 private:
  const Pattern& pattern_;
  std::vector<std::uint8_t> pixels_;
  py::module_ skia_;
  py::object surface_, canvas_, draw_path_, paint_, path_;
};

}  // namespace

Rasterizer skia_rasterizer() {
  return {"Skia", false, [](const Pattern& pattern, double) -> std::unique_ptr<Drawing> {
            return std::make_unique<SkiaDrawing>(pattern);
          }};
}

}  // namespace prefilter::bench
