// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "fuzz/targets.h"
#include "prefilter/base/error.h"
#include "prefilter/shapes/path_data.h"
#include "prefilter/shapes/rasterize.h"
#include "prefilter/shapes/set_operations.h"
#include "prefilter/shapes/stroke.h"

namespace prefilter {
namespace {

constexpr std::size_t kMostRead = 100'000;
// As many as are drawn a hundred times a second.
constexpr std::size_t kMostDrawn = 100;

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Outline outline_of(const PathSteps& steps) {
  Outline outline;
  const double* at = steps.numbers.data();
  for (const char letter : steps.letters) {
    switch (letter) {
      case 'M':
        outline.move_to({at[0], at[1]});
        break;
      case 'W':
        outline.conic_to({at[0], at[1]}, at[2], {at[3], at[4]});
        break;
      case 'Z':
        outline.close();
        break;
      default: {
        std::vector<Point2> points;
        for (int k = 0; k < number_count(letter); k += 2) points.push_back({at[k], at[k + 1]});
        outline.curve_to(points);
      }
    }
    at += number_count(letter);
  }
  return outline;
}

// An image of two layers of an outline; the bits choose among the ways to draw it.
void draw(const Outline& outline, unsigned bits) {
  const FillRule rule = (bits & 1) != 0 ? FillRule::kEvenOdd : FillRule::kNonzero;
  Paint half;
  half.constant[0] = half.constant[1] = 0.5;
  half.channels = 2;
  std::vector<Shape> shapes(2, Shape{outline, rule, half, false});
  shapes[1].outline = outline.transformed({{0.9, 0.1}, {-0.1, 0.9}, {1.0, 2.0}});
  RasterOptions options;
  options.width = options.height = 24;
  options.run = prefilter::Run(1);
  options.overlap = (bits & 2) != 0 ? Overlap::kAdd : Overlap::kCover;
  const auto filters = raster_filters();
  options.filter = filters[(bits >> 2) % filters.size()];
  rasterize(shapes, options);
}

}  // namespace

void read_path(std::span<const std::uint8_t> bytes) {
  PathSteps steps;
  if (read_path_data(text_of(bytes), kMostRead, &steps) != PathOutcome::kTooMany) {
    drawn_box(steps.letters, steps.numbers);
  }
  std::size_t needed = 0;
  for (const char letter : steps.letters) needed += static_cast<std::size_t>(number_count(letter));
  if (needed != steps.numbers.size()) throw std::logic_error("letters and numbers differ");
  std::vector<double> numbers;
  read_numbers(text_of(bytes), &numbers);
}

void draw_path(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return;
  const unsigned bits = bytes.front();
  PathSteps steps;
  if (read_path_data(text_of(bytes.subspan(1)), kMostDrawn, &steps) == PathOutcome::kTooMany)
    return;
  const Outline outline = outline_of(steps);
  try {
    if (bits < 0x80) {
      draw(outline, bits);
    } else if (bits < 0xc0) {
      StrokeOptions options;
      options.join = static_cast<StrokeJoin>(bits % 3);
      options.cap = static_cast<StrokeCap>(bits / 3 % 3);
      // Some for each line, however long it is.
      const Box2 box = control_box(outline);
      const double size = std::max(box.high.x - box.low.x, box.high.y - box.low.y);
      if (bits >= 0xb0 && size > 0.0) options.dashes = {size / 20.0, size / 50.0};
      draw(stroke(outline, options), bits & 1);
    } else {
      const Outline other = outline.transformed({{0.0, 1.0}, {-1.0, 0.0}, {10.0, 0.0}});
      combine(outline, FillRule::kNonzero, other, FillRule::kEvenOdd,
              static_cast<OutlineOperation>(bits % 3));
    }
  } catch (const Error&) {
  }
}

}  // namespace prefilter
