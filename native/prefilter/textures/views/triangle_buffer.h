// SPDX-License-Identifier: GPL-3.0-or-later

// A z-buffer of triangle indices: the frontmost triangle at each sample of a view.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/textures/views/view_plan.h"

namespace prefilter {

/// The texture coordinates of a triangle as linear functions of the pixel position (x, y): u =
/// at[0] + x * by_x[0] + y * by_y[0], and v the same with [1].
struct ScreenMap {
  std::array<double, 2> at{};
  std::array<double, 2> by_x{};
  std::array<double, 2> by_y{};
};

/// Renders the triangles of a view's surface.
class TriangleBuffer {
 public:
  static constexpr std::uint32_t kNothing = 0xFFFFFFFFU;

  /// Uses the camera of the second frame if `is_second`.
  TriangleBuffer(const View& view, bool is_second);

  /// Draws the frontmost triangle at samples x samples points per pixel of rows [begin, end).
  /// Sample (i, j), counted from the left edge and row `begin`, is at [j * samples * size + i];
  /// kNothing where no triangle is.
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
