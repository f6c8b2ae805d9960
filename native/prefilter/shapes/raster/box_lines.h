// SPDX-License-Identifier: GPL-3.0-or-later

// Lines under the box filter.
#pragma once

#include <cstdint>

#include "prefilter/base/outline.h"
#include "prefilter/shapes/raster/difference_rows.h"

namespace prefilter {

/// Largest coordinate of a line, in pixels. Coordinates are rounded to multiples of kBoxUnit, which
/// is the last bit of a double at 2^25 pixels; lines farther away take another path.
inline constexpr double kMaxBoxCoordinate = 1 << 24;

/// Rounds to a multiple of kBoxUnit.
inline double rounded_to_unit(double value) {
  constexpr double kShift = 1.5 * (1 << 26);
  return (value + kShift) - kShift;
}

/// Accumulates a chain of lines. A line and its reverse cancel to the last bit, independent of the
/// preceding lines.
class BoxLines {
 public:
  explicit BoxLines(DifferenceRows* rows) : rows_(*rows) {}

  void move_to(const Point2& point) {
    flush();
    begin_at({rounded_to_unit(point.x), rounded_to_unit(point.y)});
  }

  /// Both ends must be within kMaxBoxCoordinate.
  void line_to(const Point2& point) {
    if (!stays_in_cell(point)) leave_cell(point);
  }

  /// Adds several lines. Stops before a point that is too far, and returns the number of lines
  /// added.
  std::size_t lines_to(const Point2* points, std::size_t count);

  /// Adds the pending part of the last cell; must be called at the end.
  void flush();

 private:
  static constexpr std::uint32_t kOne = 1U << kBoxBits;

  // A line within a cell costs one multiplication, as its ends are whole numbers there.
  bool stays_in_cell(const Point2& point) {
    constexpr double kScale = kOne;
    const IntFour place = round_to_int((DoublePair{point.x, point.y} - cell_) * kScale);
    const std::uint32_t x = place[0];
    const std::uint32_t y = place[1];
    if (((x | y) & ~(kOne - 1)) != 0) return false;
    const std::int64_t height = static_cast<std::int64_t>(y) - y_;
    const std::int64_t twice = (static_cast<std::int64_t>(x) + x_) * height;
    // Halves are rounded away from 0, so that the reverse gives the negative.
    part_ += (twice + kOne + (twice >> 63)) >> (kBoxBits + 1);
    x_ = x;
    y_ = y;
    return true;
  }
  void leave_cell(const Point2& point);
  void begin_at(const Point2& point);
  void add_line(Point2 low, Point2 high, double scale);
  // Adds rows in which a line is left of the image.
  void add_left(double from, double to, double scale);
  template <int kColumns>
  void add_narrow(const Point2& low, double slope, double begin, double end, double scale);
  void add_wide(const Point2& low, double slope, double begin, double end, double scale);

  DifferenceRows& rows_;
  DoublePair cell_{};    // lower left corner
  std::uint32_t x_ = 0;  // current point, in the cell
  std::uint32_t y_ = 0;
  std::uint32_t begin_y_ = 0;  // where the chain entered the cell
  std::int64_t part_ = 0;      // integral of x dy in the cell since then
};

}  // namespace prefilter
