// SPDX-License-Identifier: GPL-3.0-or-later

// Splits a path to stroke into pieces whose offset curves are simple.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/shapes/outline/dashes.h"

namespace prefilter {

/// Smallest tolerance, relative to the largest coordinate. Points of curves are rounded by about
/// 2^-51 of it.
inline constexpr double kMinRelativeStrokeTolerance = 0x1p-44;

/// Piece of a path with the unit normals to its left at both ends.
struct StrokePiece {
  enum class Kind : std::uint8_t {
    kLine,   // one normal
    kCurve,  // cubics on both sides
    kFlat,   // straight within the tolerance, with different normals
  };

  Kind kind = Kind::kLine;
  bool is_smooth = false;  // continues the previous piece
  bool is_cusp = false;    // has a corner with the previous piece within one curve
  Point2 begin;
  Point2 end;
  Point2 begin_normal;
  Point2 end_normal;
  std::array<Point2, 2> left_controls;  // for kCurve: the inner control points
  std::array<Point2, 2> right_controls;

  double length() const {
    const Point2 chord = end - begin;
    return elementary::hypot(chord.x, chord.y);
  }
};

/// Cuts the curves of a path into consecutive pieces. Lines are kept; other curves are cut until
/// the offset curves at `half_width` are within `tolerance` of the pieces' sides. Empty if the path
/// has no length.
std::vector<StrokePiece> stroke_pieces(const StrokePath& path, double half_width, double tolerance);

}  // namespace prefilter
