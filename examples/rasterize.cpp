// SPDX-License-Identifier: GPL-3.0-or-later

// A path of curves, filled and outlined, as a PPM image.
//
// usage: rasterize OUT.ppm
#include "prefilter/shapes/rasterize.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/images/transfer.h"
#include "prefilter/shapes/stroke.h"

namespace {

using prefilter::Point2;

/// A heart, in pixels; y is up.
prefilter::Outline heart() {
  prefilter::Outline path;
  path.move_to({80.0, 20.0});
  path.curve_to(std::array<Point2, 3>{{{120.0, 52.0}, {148.0, 80.0}, {148.0, 108.0}}});
  path.curve_to(std::array<Point2, 3>{{{148.0, 146.0}, {96.0, 152.0}, {80.0, 116.0}}});
  path.curve_to(std::array<Point2, 3>{{{64.0, 152.0}, {12.0, 146.0}, {12.0, 108.0}}});
  path.curve_to(std::array<Point2, 3>{{{12.0, 80.0}, {40.0, 52.0}, {80.0, 20.0}}});
  path.close();
  return path;
}

prefilter::Shape painted(const prefilter::Outline& outline, double red, double green, double blue) {
  prefilter::Shape shape;
  shape.outline = outline;
  shape.paint.channels = 3;
  shape.paint.constant = {red, green, blue, 0.0};
  return shape;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: rasterize OUT.ppm\n");
    return 2;
  }
  try {
    const prefilter::Outline path = heart();
    prefilter::StrokeOptions pen;
    pen.width = 5.0;
    pen.join = prefilter::StrokeJoin::kRound;
    const std::vector<prefilter::Shape> shapes = {
        painted(path, 0.8, 0.05, 0.1), painted(prefilter::stroke(path, pen), 0.1, 0.0, 0.02)};

    prefilter::RasterOptions options;
    options.width = 160;
    options.height = 160;
    options.filter = "box";
    options.background = {1.0F, 1.0F, 1.0F};
    const prefilter::Image image = prefilter::rasterize(shapes, options);

    const std::vector<std::uint8_t> bytes = prefilter::to_bytes(image.view(), true, 0);
    std::ofstream file(argv[1], std::ios::binary);
    file << "P6\n" << image.width << ' ' << image.height << "\n255\n";
    const std::size_t row_size = 3 * image.width;
    for (std::size_t row = image.height; row-- > 0;) {  // row 0 is the lowest
      file.write(reinterpret_cast<const char*>(bytes.data() + row * row_size), row_size);
    }
    file.close();
    if (!file) {
      std::perror(argv[1]);
      return 1;
    }
  } catch (const prefilter::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
