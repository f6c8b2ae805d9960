// SPDX-License-Identifier: GPL-3.0-or-later

// Which triangles are in front, in a view.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/textures/views/view_plan.h"

namespace prefilter {

/// Where a triangle's texture coordinates are on the screen: u = at[0] + x * by_x[0] + y * by_y[0]
/// at (x, y), in pixels, and likewise v.
struct ScreenMap {
  std::array<double, 2> at{};
  std::array<double, 2> by_x{};
  std::array<double, 2> by_y{};
};

/// The triangles of a view's surface on the screen.
class SeenTriangles {
 public:
  static constexpr std::uint32_t kNothing = 0xFFFFFFFFU;

  /// Of the second frame where `is_second`.
  SeenTriangles(const View& view, bool is_second);

  /// The triangle in front at each of samples x samples points of the pixels of rows [begin, end):
  /// of sample (i, j), counted over the whole frame from row `begin` on, at [j * samples * size +
  /// i]. kNothing where there is none.
  void draw(int begin, int end, int samples, std::vector<std::uint32_t>* triangles);

  ScreenMap map_of(std::uint32_t triangle) const;

 private:
  struct Point {
    double x;
    double y;
    float depth;  // toward the viewer
  };

  const View* view_;
  std::vector<Point> points_;
  std::vector<float> depths_;  // of the samples that are drawn
};

}  // namespace prefilter
