// SPDX-License-Identifier: GPL-3.0-or-later

// Test patterns, some rebuilt from their description in the section on rasterizing (2.3).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace prefilter::bench {

/// The next command of a path; `point_count` returns the number of points that it takes.
enum class Verb : std::uint8_t { kMove = 0, kLine = 1, kQuadratic = 2, kCubic = 3, kClose = 4 };

int point_count(Verb verb);

/// Closed contours, in pixels, of polynomial Bezier curves. Row 0 is at y from 0 to 1.
struct Path {
  std::vector<Verb> verbs;
  std::vector<double> points;  // x and y in turns

  void move_to(double x, double y);
  void line_to(double x, double y);
  void quadratic_to(double x1, double y1, double x2, double y2);
  void cubic_to(double x1, double y1, double x2, double y2, double x3, double y3);
  void close();
};

/// Shapes that do not overlap, in one path, and the image that they are drawn into.
struct Pattern {
  std::string name;
  int width;
  int height;
  Path path;
  bool curved;
  int contours_per_shape;
};

/// Figure 2.5: a plane of lines in perspective, 256 quads that are 1024 lines. 1/4 line per pixel
/// at row 0, 2 lines per pixel at the last; most of the plane is outside at row 0.
Pattern fan();
/// Figure 2.6, first row: 32 radial triangles, 96 lines.
Pattern star();
/// Figure 2.6, second row: 32 rings around a corner, each of two quadratic curves outside, two
/// inside and two radial lines. All rings have the same area, as in a zone plate.
Pattern rings();
/// 3390 letters o, each of two contours of four cubics: 27,120 cubics.
Pattern glyphs();
/// A circle with a million vertices.
Pattern circle();
/// A disc of four cubics.
Pattern disc();

/// All of them, or those with these names.
std::vector<Pattern> patterns(const std::vector<std::string>& names = {});

/// 64 quads side by side that together are the whole image of 64 x 64 pixels; the edges that they
/// share lean over by a pixel, so that they are in the middle of pixels at half of the height.
Pattern abutting_quads();

/// Each contour of a path as a path.
std::vector<Path> contours(const Path& path);

}  // namespace prefilter::bench
