// SPDX-License-Identifier: GPL-3.0-or-later

// A stroke is put together from quadrilaterals along the curve, wedges at the outside of corners
// and caps, all counter-clockwise: the sum of their boundaries runs along both sides, and through
// the corner itself on its inside. Winding numbers are nowhere negative, so the non-zero rule
// unites the pieces.
#include "prefilter/outline/stroke.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "prefilter/base/elementary.h"
#include "prefilter/base/error.h"
#include "prefilter/base/text.h"
#include "prefilter/outline/dashes.h"

namespace prefilter {
namespace {

constexpr int kMostDashes = 1000000;
constexpr int kDeepest = 18;

double length(const Point2& p) { return elementary::hypot(p.x, p.y); }
Point2 unit(const Point2& p) { return (1.0 / length(p)) * p; }
Point2 left_of(const Point2& direction) { return {-direction.y, direction.x}; }

// A piece of the pen's way with its normals, to the left, at both ends.
struct Piece {
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
  std::array<Point2, 2> left_controls;  // of kCurve
  std::array<Point2, 2> right_controls;

  double length() const { return prefilter::length(end - begin); }
};

// A direction of a curve at an end: to the next control point that is elsewhere.
Point2 begin_direction(std::span<const Point2> controls) {
  for (std::size_t i = 1; i < controls.size(); ++i) {
    if (!(controls[i] == controls[0])) return unit(controls[i] - controls[0]);
  }
  return {1.0, 0.0};
}
Point2 end_direction(std::span<const Point2> controls) {
  for (std::size_t i = controls.size() - 1; i > 0; --i) {
    if (!(controls[i - 1] == controls.back())) return unit(controls.back() - controls[i - 1]);
  }
  return {1.0, 0.0};
}

// How much a control polygon turns in all, in radians.
double turning(std::span<const Point2> controls) {
  double sum = 0.0;
  Point2 last{};
  for (std::size_t i = 0; i + 1 < controls.size(); ++i) {
    const Point2 step = controls[i + 1] - controls[i];
    if (step == Point2{}) continue;
    if (!(last == Point2{}))
      sum += std::fabs(elementary::atan2(cross(last, step), dot(last, step)));
    last = step;
  }
  return sum;
}

double distance_from_chord(std::span<const Point2> controls) {
  const Point2 chord = controls.back() - controls.front();
  const double size = prefilter::length(chord);
  double largest = 0.0;
  for (const Point2& point : controls) {
    const Point2 off = point - controls.front();
    largest = std::max(largest,
                       size > 0.0 ? std::fabs(cross(chord, off)) / size : prefilter::length(off));
  }
  return largest;
}

Point2 cubic_point(const Point2& a, const std::array<Point2, 2>& controls, const Point2& b,
                   double t) {
  const std::array<Point2, 4> points = {a, controls[0], controls[1], b};
  return point_at({points, 0.0}, t);
}

// Cuts curves into pieces.
class PieceMaker {
 public:
  PieceMaker(double half_width, double tolerance)
      : half_width_(half_width),
        tolerance_(0.5 * tolerance),
        most_turning_(half_width > tolerance_
                          ? std::min(0.5, 2.0 * elementary::acos(1.0 - tolerance_ / half_width))
                          : 0.5) {}

  std::vector<Piece> pieces_of(const StrokePath& path) {
    pieces_.clear();
    for (const PartOfCurve& part : path.curves) {
      const Curve curve = part.curve();
      const std::size_t first = pieces_.size();
      if (curve.degree() == 1) {
        append_line(curve.begin(), curve.end());
      } else {
        append_curve_pieces(curve, kDeepest);
      }
      for (std::size_t i = first + 1; i < pieces_.size(); ++i) {
        if (!pieces_[i].is_cusp) pieces_[i].is_smooth = true;
      }
    }
    return std::move(pieces_);
  }

 private:
  void append_line(const Point2& begin, const Point2& end) {
    if (begin == end) return;
    Piece piece;
    piece.begin = begin;
    piece.end = end;
    piece.begin_normal = piece.end_normal = left_of(unit(end - begin));
    if (!std::isfinite(piece.begin_normal.x + piece.begin_normal.y)) return;
    pieces_.push_back(piece);
  }

  void append_curve_pieces(const Curve& curve, int depth) {
    const double turn = turning(curve.controls);
    if (turn < 0.45 * std::numbers::pi && append_sides(curve)) return;
    const bool is_flat = distance_from_chord(curve.controls) <= tolerance_;
    if (is_flat && turn <= most_turning_) {
      append_flat(curve);
      return;
    }
    if (depth == 0) {
      const std::size_t count = pieces_.size();
      append_line(curve.begin(), curve.end());
      if (pieces_.size() > count) pieces_.back().is_cusp = true;
      after_cusp_ = true;
      return;
    }
    append_curve_pieces(PartOfCurve(curve, 0.0, 0.5).curve(), depth - 1);
    append_curve_pieces(PartOfCurve(curve, 0.5, 1.0).curve(), depth - 1);
  }

  Piece with_normals(const Curve& curve, Piece::Kind kind) {
    Piece piece;
    piece.kind = kind;
    piece.begin = curve.begin();
    piece.end = curve.end();
    piece.begin_normal = left_of(begin_direction(curve.controls));
    piece.end_normal = left_of(end_direction(curve.controls));
    piece.is_cusp = std::exchange(after_cusp_, false);
    return piece;
  }

  // Cubics of the offset curves' ends and derivatives there, where these are near enough.
  bool append_sides(const Curve& curve) {
    Piece piece = with_normals(curve, Piece::Kind::kCurve);
    const Point2 begin_step = derivative_at(curve, 0.0);
    const Point2 end_step = derivative_at(curve, 1.0);
    const double begin_curvature = curvature(curve.controls, curve.weight, false);
    const double end_curvature = curvature(curve.controls, curve.weight, true);
    if (!(length(begin_step) > 0.0) || !(length(end_step) > 0.0) ||
        !std::isfinite(begin_curvature + end_curvature)) {
      return false;
    }
    for (const double side : {half_width_, -half_width_}) {
      const double begin_stretch = 1.0 - side * begin_curvature;
      const double end_stretch = 1.0 - side * end_curvature;
      if (begin_stretch < 0.02 || end_stretch < 0.02) return false;
      const Point2 begin = piece.begin + side * piece.begin_normal;
      const Point2 end = piece.end + side * piece.end_normal;
      const std::array<Point2, 2> controls = {begin + (begin_stretch / 3.0) * begin_step,
                                              end - (end_stretch / 3.0) * end_step};
      for (const double t : {0.2, 0.5, 0.8}) {
        const Point2 step = derivative_at(curve, t);
        if (!(length(step) > 0.0)) return false;
        const Point2 ahead = unit(step);
        const Point2 expected = point_at(curve, t) + side * left_of(ahead);
        const Point2 off = cubic_point(begin, controls, end, t) - expected;
        // Along the curve it may be off by more.
        if (!(std::fabs(cross(ahead, off)) <= 0.7 * tolerance_) ||
            !(std::fabs(dot(ahead, off)) <= 20.0 * tolerance_)) {
          return false;
        }
      }
      (side > 0.0 ? piece.left_controls : piece.right_controls) = controls;
    }
    pieces_.push_back(piece);
    return true;
  }

  // The signed curvature at an end.
  static double curvature(std::span<const Point2> controls, double weight, bool at_end) {
    const std::size_t last = controls.size() - 1;
    const Point2 first_step =
        at_end ? controls[last] - controls[last - 1] : controls[1] - controls[0];
    const Point2 second_step =
        at_end ? controls[last - 1] - controls[last - 2] : controls[2] - controls[1];
    const double size = length(first_step);
    const double turn = at_end ? cross(second_step, first_step) : cross(first_step, second_step);
    const double degree = static_cast<double>(last);
    const double factor = weight > 0.0 ? 0.5 / (weight * weight) : (degree - 1.0) / degree;
    return factor * turn / (size * size * size);
  }

  void append_flat(const Curve& curve) {
    if (curve.begin() == curve.end()) return;
    Piece piece = with_normals(curve, Piece::Kind::kFlat);
    pieces_.push_back(piece);
  }

  double half_width_;
  double tolerance_;
  double most_turning_;
  bool after_cusp_ = false;
  std::vector<Piece> pieces_;
};

// Draws what a pen covers along pieces.
class Pen {
 public:
  Pen(const StrokeOptions& options, double tolerance, Outline* outline)
      : options_(options),
        half_width_(0.5 * options.width),
        tolerance_(tolerance),
        outline_(outline) {}

  void draw(const std::vector<Piece>& pieces, bool is_closed) {
    Outline left = side(pieces, is_closed, half_width_);
    Outline right = side(pieces, is_closed, -half_width_);
    append_side(right, false, true);
    if (is_closed) {
      outline_->close();
      append_side(left, true, true);
    } else {
      cap(pieces.back().end, pieces.back().end_normal);
      append_side(left, true, false);
      cap(pieces.front().begin, -1.0 * pieces.front().begin_normal);
    }
    outline_->close();
  }

  void dot_at(const Point2& point, const Point2& direction) {
    if (options_.cap == StrokeCap::kButt) return;
    const Point2 normal = left_of(direction);
    outline_->move_to(point - half_width_ * normal);
    cap(point, normal);
    cap(point, -1.0 * normal);
    outline_->close();
  }

 private:
  // From the right to the left of a way that ends.
  void cap(const Point2& end, const Point2& normal) {
    const Point2 ahead = {normal.y, -normal.x};
    const Point2 left = half_width_ * normal;
    const Point2 front = half_width_ * ahead;
    switch (options_.cap) {
      case StrokeCap::kButt:
        break;
      case StrokeCap::kSquare:
        outline_->line_to(end - left + front);
        outline_->line_to(end + left + front);
        break;
      case StrokeCap::kRound:
        outline_->conic_to(end - left + front, std::sqrt(0.5), end + front);
        outline_->conic_to(end + left + front, std::sqrt(0.5), end + left);
        return;
    }
    outline_->line_to(end + left);
  }

  // One side of the way, `offset` to its left, as the one contour of an outline.
  Outline side(const std::vector<Piece>& pieces, bool is_closed, double offset) const {
    Outline path;
    const std::size_t count = pieces.size();
    const auto after = [&](std::size_t i) -> const Piece* {
      if (i + 1 < count) return &pieces[i + 1];
      return is_closed ? &pieces.front() : nullptr;
    };
    const bool begins_inside = is_closed && meets_inside(pieces.back(), pieces[0], offset);
    path.move_to(begins_inside ? mitered(pieces[0].begin, pieces.back().end_normal,
                                         pieces[0].begin_normal, offset)
                               : pieces[0].begin + offset * pieces[0].begin_normal);
    for (std::size_t i = 0; i < count; ++i) {
      const Piece& piece = pieces[i];
      const Piece* next = after(i);
      const bool trims = next != nullptr && meets_inside(piece, *next, offset);
      const Point2 end = trims ? mitered(piece.end, piece.end_normal, next->begin_normal, offset)
                               : piece.end + offset * piece.end_normal;
      if (is_folded(piece, offset)) {
        const std::size_t first = i;
        while (i + 1 < count && pieces[i + 1].is_smooth && is_folded(pieces[i + 1], offset)) ++i;
        append_fold(std::span(pieces).subspan(first, i + 1 - first), offset, &path);
        next = after(i);
        if (next != nullptr) join(pieces[i], *next, offset, &path);
        continue;
      }
      append_along(piece, offset, end, &path);
      if (next != nullptr && !trims) join(piece, *next, offset, &path);
    }
    return path;
  }

  void append_along(const Piece& piece, double offset, const Point2& end, Outline* path) const {
    if (piece.kind == Piece::Kind::kCurve) {
      const auto& controls = offset > 0.0 ? piece.left_controls : piece.right_controls;
      const std::array<Point2, 3> points = {controls[0], controls[1], end};
      path->curve_to(points);
      return;
    }
    path->line_to(end);
  }

  static bool is_folded(const Piece& piece, double offset) {
    const Point2 chord = piece.end - piece.begin;
    return piece.kind == Piece::Kind::kFlat &&
           dot(chord + offset * (piece.end_normal - piece.begin_normal), chord) <= 0.0;
  }

  // Where a side runs backwards the normals cross before they reach it, and what lies between
  // their crossings and the side counts negatively. Twice that area is added: the way goes along
  // the crossings, back along the side, and along the crossings again.
  static void append_fold(std::span<const Piece> pieces, double offset, Outline* path) {
    const auto append_crossings = [&] {
      for (const Piece& piece : pieces) {
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

  // Whether the ways beside two normals go on from each other.
  bool is_smooth(const Point2& a, const Point2& b) const {
    return dot(a, b) > 0.0 && half_width_ * std::fabs(cross(a, b)) <= 0.5 * tolerance_;
  }

  // Where the offset lines beside two normals cross.
  static Point2 mitered(const Point2& corner, const Point2& a, const Point2& b, double offset) {
    return corner + (offset / (1.0 + dot(a, b))) * (a + b);
  }

  // Whether a side is on the inside of a corner of two lines long enough for their offsets to meet.
  bool meets_inside(const Piece& piece, const Piece& next, double offset) const {
    const Point2& a = piece.end_normal;
    const Point2& b = next.begin_normal;
    if (piece.kind != Piece::Kind::kLine || next.kind != Piece::Kind::kLine || is_smooth(a, b)) {
      return false;
    }
    const double turn = cross(a, b);
    if ((turn > 0.0) != (offset > 0.0) || dot(a, b) <= -0.999) return false;
    const double reach = half_width_ * std::fabs(turn) / (1.0 + dot(a, b));
    return reach <= std::min(piece.length(), next.length());
  }

  void join(const Piece& piece, const Piece& next, double offset, Outline* path) const {
    const Point2& corner = piece.end;
    const Point2& a = piece.end_normal;
    const Point2& b = next.begin_normal;
    const Point2 begin = corner + offset * b;
    if (is_smooth(a, b)) return;
    const double turn = cross(a, b);
    if ((turn > 0.0 || (turn == 0.0 && dot(a, b) < 0.0)) == (offset > 0.0)) {
      path->line_to(corner);
      path->line_to(begin);
      return;
    }
    const StrokeJoin style = next.is_smooth || next.is_cusp ? StrokeJoin::kRound : options_.join;
    if (style == StrokeJoin::kRound) {
      arc(corner, a, b, offset, path);
      return;
    }
    // The square of the miter's length, in widths, is 2 / (1 + cos).
    if (style == StrokeJoin::kMiter &&
        2.0 <= options_.miter_limit * options_.miter_limit * (1.0 + dot(a, b))) {
      path->line_to(mitered(corner, a, b, offset));
    }
    path->line_to(begin);
  }

  // A circle's arc around the outside of a corner, of conics of a quarter at the most.
  static void arc(const Point2& corner, const Point2& a, const Point2& b, double offset,
                  Outline* path) {
    double turn = elementary::atan2(cross(a, b), dot(a, b));
    // About to turn back: around on this side.
    if ((turn > 0.0) == (offset > 0.0)) turn = -turn;
    const int parts = std::fabs(turn) > 0.5 * std::numbers::pi * (1.0 + 1e-9) ? 2 : 1;
    const double step = turn / parts;
    const double weight = elementary::cos(0.5 * step);
    Point2 from = a;
    for (int i = 1; i <= parts; ++i) {
      const Point2 to = i == parts
                            ? b
                            : Point2{elementary::cos(step) * a.x - elementary::sin(step) * a.y,
                                     elementary::sin(step) * a.x + elementary::cos(step) * a.y};
      path->conic_to(corner + (offset / (1.0 + dot(from, to))) * (from + to), weight,
                     corner + offset * to);
      from = to;
    }
  }

  void append_side(const Outline& path, bool reversed, bool begins) {
    const auto segments = path.segments();
    if (begins) {
      outline_->move_to(reversed ? path.points().back() : path.points().front());
    }
    for (std::size_t i = 0; i < segments.size(); ++i) {
      const Outline::Segment& segment = segments[reversed ? segments.size() - 1 - i : i];
      const Curve curve = curve_of(path, segment);
      append_curve(curve, reversed, reversed ? curve.begin() : curve.end(), outline_);
    }
  }

  const StrokeOptions& options_;
  double half_width_;
  double tolerance_;
  Outline* outline_;
};

void check(const StrokeOptions& options) {
  const auto check_length = [](double value, const char* name) {
    if (!(value >= 0.0) || !std::isfinite(value)) {
      throw_invalid(std::string(name) + ": " + to_text(value) + "; must be finite, and 0 or more");
    }
  };
  check_length(options.width, "width");
  for (const double dash : options.dashes) check_length(dash, "dashes");
  if (!std::isfinite(options.dash_offset)) {
    throw_invalid("dash_offset: " + to_text(options.dash_offset) + "; must be finite");
  }
  if (!(options.miter_limit >= 1.0)) {
    throw_invalid("miter_limit: " + to_text(options.miter_limit) + "; must be 1 or more");
  }
}

StrokePath path_of(const Outline& outline, std::size_t contour) {
  StrokePath path;
  path.is_closed = outline.is_closed(contour);
  path.point = outline.begin_of(contour);
  for (const Outline::Segment& segment : outline.contour(contour)) {
    const Curve curve = curve_of(outline, segment);
    const bool is_point = std::all_of(curve.controls.begin(), curve.controls.end(),
                                      [&](const Point2& p) { return p == curve.begin(); });
    if (!is_point) path.curves.emplace_back(curve, 0.0, 1.0);
  }
  return path;
}

}  // namespace

Outline stroke(const Outline& outline, const StrokeOptions& options, double tolerance) {
  check(options);
  Outline covered;
  if (options.width == 0.0) return covered;
  std::vector<double> pattern = options.dashes;
  if (pattern.size() % 2 != 0) pattern.insert(pattern.end(), pattern.begin(), pattern.end());
  const double period = std::accumulate(pattern.begin(), pattern.end(), 0.0);
  double offset = period > 0.0 ? std::fmod(options.dash_offset, period) : 0.0;
  if (offset < 0.0) offset += period;

  PieceMaker maker(0.5 * options.width, tolerance);
  Pen pen(options, tolerance, &covered);
  for (std::size_t c = 0; c < outline.contour_count(); ++c) {
    if (outline.contour(c).empty() && !outline.is_closed(c)) continue;
    std::vector<StrokePath> paths = {path_of(outline, c)};
    if (period > 0.0 && std::isfinite(period) && !paths[0].curves.empty()) {
      const StrokePath whole = std::move(paths[0]);
      paths.clear();
      double way = 0.0;
      for (const PartOfCurve& part : whole.curves) way += arc_length(part.curve(), 0.0, 1.0);
      if (way / period * static_cast<double>(pattern.size() / 2) > kMostDashes) {
        throw_invalid("dashes: more than " + std::to_string(kMostDashes) + " on one contour");
      }
      append_dashes(whole, pattern, offset, &paths);
    }
    for (const StrokePath& path : paths) {
      const std::vector<Piece> pieces = maker.pieces_of(path);
      if (pieces.empty()) {
        pen.dot_at(path.point, path.direction);
      } else {
        pen.draw(pieces, path.is_closed);
      }
    }
  }
  std::optional<Outline> united = resolved(covered, FillRule::kNonzero, tolerance);
  return united ? std::move(*united) : covered;
}

}  // namespace prefilter
