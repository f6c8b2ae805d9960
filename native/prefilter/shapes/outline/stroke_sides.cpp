// SPDX-License-Identifier: GPL-3.0-or-later

// Offsets, joins and caps as SVG 1.1, section 11.4, defines them.
#include "prefilter/shapes/outline/stroke_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "prefilter/base/elementary.h"

namespace prefilter {
namespace {

// The joint of two pieces: the normals before and after it, and the signed offset of the side.
struct Corner {
  Point2 at;
  Point2 before;
  Point2 after;
  double offset = 0.0;

  double turn() const { return cross(before, after); }
  double cosine() const { return dot(before, after); }
  // Whether the offsets before and after the joint coincide within half the tolerance.
  bool is_smooth(double tolerance) const {
    return cosine() > 0.0 && std::fabs(offset) * std::fabs(turn()) <= 0.5 * tolerance;
  }
  // Intersection of the offset lines before and after the joint.
  Point2 mitered() const { return at + (offset / (1.0 + cosine())) * (before + after); }
};

Corner corner_of(const StrokePiece& piece, const StrokePiece& next, double offset) {
  return {piece.end, piece.end_normal, next.begin_normal, offset};
}

// Whether a side is on the inside of a corner between two lines that are long enough for their
// offsets to intersect.
bool offsets_meet_inside(const StrokePiece& piece, const StrokePiece& next, double offset,
                         double tolerance) {
  const Corner corner = corner_of(piece, next, offset);
  if (piece.kind != StrokePiece::Kind::kLine || next.kind != StrokePiece::Kind::kLine ||
      corner.is_smooth(tolerance)) {
    return false;
  }
  const double turn = corner.turn();
  if ((turn > 0.0) != (offset > 0.0) || corner.cosine() <= -0.999) return false;
  const double reach = std::fabs(offset) * std::fabs(turn) / (1.0 + corner.cosine());
  return reach <= std::min(piece.length(), next.length());
}

// Appends a circular arc around the outside of a corner, as conics of at most a quarter circle.
void append_arc(const Corner& corner, Outline* path) {
  double turn = elementary::atan2(corner.turn(), corner.cosine());
  // At a reversal the sign of the turn is arbitrary; the arc must bulge on this side.
  if ((turn > 0.0) == (corner.offset > 0.0)) turn = -turn;
  const int parts = std::fabs(turn) > 0.5 * std::numbers::pi * (1.0 + 1e-9) ? 2 : 1;
  const double step = turn / parts;
  const double weight = elementary::cos(0.5 * step);
  Corner part = corner;
  for (int i = 1; i <= parts; ++i) {
    const Point2& a = corner.before;
    part.after = i == parts ? corner.after
                            : Point2{elementary::cos(step) * a.x - elementary::sin(step) * a.y,
                                     elementary::sin(step) * a.x + elementary::cos(step) * a.y};
    path->conic_to(part.mitered(), weight, corner.at + corner.offset * part.after);
    part.before = part.after;
  }
}

void append_join(const Corner& corner, StrokeJoin join, double miter_limit, double tolerance,
                 Outline* path) {
  if (corner.is_smooth(tolerance)) return;
  const Point2 begin = corner.at + corner.offset * corner.after;
  const double turn = corner.turn();
  if ((turn > 0.0 || (turn == 0.0 && corner.cosine() < 0.0)) == (corner.offset > 0.0)) {
    path->line_to(corner.at);
    path->line_to(begin);
    return;
  }
  if (join == StrokeJoin::kRound) {
    append_arc(corner, path);
    return;
  }
  // The squared ratio of miter length to width is 2 / (1 + cos).
  if (join == StrokeJoin::kMiter && 2.0 <= miter_limit * miter_limit * (1.0 + corner.cosine())) {
    path->line_to(corner.mitered());
  }
  path->line_to(begin);
}

void append_along(const StrokePiece& piece, double offset, const Point2& end, Outline* path) {
  if (piece.kind == StrokePiece::Kind::kCurve) {
    const auto& controls = offset > 0.0 ? piece.left_controls : piece.right_controls;
    const std::array<Point2, 3> points = {controls[0], controls[1], end};
    path->curve_to(points);
    return;
  }
  path->line_to(end);
}

bool is_folded(const StrokePiece& piece, double offset) {
  const Point2 chord = piece.end - piece.begin;
  return piece.kind == StrokePiece::Kind::kFlat &&
         dot(chord + offset * (piece.end_normal - piece.begin_normal), chord) <= 0.0;
}

// Where a side runs backward the normals cross before they reach it, and the area between their
// crossings and the side counts negatively. Adding twice that area compensates: the path follows
// the crossings, returns along the side, and follows the crossings again.
void append_fold(std::span<const StrokePiece> pieces, double offset, Outline* path) {
  const auto append_crossings = [&] {
    for (const StrokePiece& piece : pieces) {
      const double turn = cross(piece.begin_normal, piece.end_normal);
      const double reach = cross(piece.end - piece.begin, piece.end_normal) / turn;
      const double share = std::isfinite(reach) ? std::clamp(reach / offset, 0.0, 1.0) : 1.0;
      path->line_to(piece.begin + (share * offset) * piece.begin_normal);
    }
    path->line_to(pieces.back().end + offset * pieces.back().end_normal);
  };
  append_crossings();
  for (std::size_t i = pieces.size(); i-- > 0;) {
    path->line_to(pieces[i].begin + offset * pieces[i].begin_normal);
  }
  append_crossings();
}

}  // namespace

Outline stroke_side(std::span<const StrokePiece> pieces, bool is_closed, double offset,
                    StrokeJoin join, double miter_limit, double tolerance) {
  Outline path;
  const std::size_t count = pieces.size();
  const auto after = [&](std::size_t i) -> const StrokePiece* {
    if (i + 1 < count) return &pieces[i + 1];
    return is_closed ? &pieces.front() : nullptr;
  };
  const auto append_corner = [&](const StrokePiece& piece, const StrokePiece& next) {
    const StrokeJoin own = next.is_smooth || next.is_cusp ? StrokeJoin::kRound : join;
    append_join(corner_of(piece, next, offset), own, miter_limit, tolerance, &path);
  };
  const bool begins_inside =
      is_closed && offsets_meet_inside(pieces.back(), pieces[0], offset, tolerance);
  const Corner at_begin{pieces[0].begin, pieces.back().end_normal, pieces[0].begin_normal, offset};
  path.move_to(begins_inside ? at_begin.mitered()
                             : pieces[0].begin + offset * pieces[0].begin_normal);
  for (std::size_t i = 0; i < count; ++i) {
    const StrokePiece& piece = pieces[i];
    const StrokePiece* next = after(i);
    if (is_folded(piece, offset)) {
      const std::size_t first = i;
      while (i + 1 < count && pieces[i + 1].is_smooth && is_folded(pieces[i + 1], offset)) ++i;
      append_fold(pieces.subspan(first, i + 1 - first), offset, &path);
      next = after(i);
      if (next != nullptr) append_corner(pieces[i], *next);
      continue;
    }
    const bool trims = next != nullptr && offsets_meet_inside(piece, *next, offset, tolerance);
    append_along(
        piece, offset,
        trims ? corner_of(piece, *next, offset).mitered() : piece.end + offset * piece.end_normal,
        &path);
    if (next != nullptr && !trims) append_corner(piece, *next);
  }
  return path;
}

void append_cap(const Point2& end, const Point2& normal, double half_width, StrokeCap cap,
                Outline* outline) {
  const Point2 left = half_width * normal;
  const Point2 front = half_width * Point2{normal.y, -normal.x};
  switch (cap) {
    case StrokeCap::kButt:
      break;
    case StrokeCap::kSquare:
      outline->line_to(end - left + front);
      outline->line_to(end + left + front);
      break;
    case StrokeCap::kRound:
      outline->conic_to(end - left + front, std::sqrt(0.5), end + front);
      outline->conic_to(end + left + front, std::sqrt(0.5), end + left);
      return;
  }
  outline->line_to(end + left);
}

}  // namespace prefilter
