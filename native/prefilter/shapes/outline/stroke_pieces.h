// SPDX-License-Identifier: GPL-3.0-or-later

// A pen's way as pieces whose sides are simple.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/shapes/outline/dashes.h"

namespace prefilter {

/// Of the largest coordinate, what no tolerance is below: points of curves are off by some 2^-51 of
/// it.
inline constexpr double kLeastStrokeTolerance = 0x1p-44;

/// A piece of a pen's way with its normals, of length 1 and to the left, at both ends.
struct StrokePiece {
  enum class Kind : std::uint8_t {
    kLine,   // one normal
    kCurve,  // both sides are cubic
    kFlat,   // as good as a line, but for the normals
  };

  Kind kind = Kind::kLine;
  bool is_smooth = false;  // goes on from the piece before it
  bool is_cusp = false;    // does not, though it is the same curve
  Point2 begin;
  Point2 end;
  Point2 begin_normal;
  Point2 end_normal;
  std::array<Point2, 2> left_controls;  // of kCurve, between the ends of the side
  std::array<Point2, 2> right_controls;

  double length() const {
    const Point2 chord = end - begin;
    return elementary::hypot(chord.x, chord.y);
  }
};

/// Cuts the curves of a path into pieces, each from where the last one ends: lines as they are,
/// others so that what lies `half_width` beside them is within `tolerance` of the pieces' sides.
/// None where the path has no length.
std::vector<StrokePiece> stroke_pieces(const StrokePath& path, double half_width, double tolerance);

}  // namespace prefilter
