// SPDX-License-Identifier: GPL-3.0-or-later

// Section 2.2 for curves and the box filter.
//
// As in box_lines.cpp, a row's pixels follow from E_k, the integral over y of the distance by which
// x exceeds a line between columns. The integral of x dy along a piece of a curve is a polynomial
// of the curve's parameter. An error in a root changes E_k, and integrals that continue to the line
// between rows at a constant x, only by its square: 1e-5 pixels by less than 1e-9 where the curve
// rises by less than 10 to 1.

#include "prefilter/shapes/raster/box_curves.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "prefilter/geometry/moments/arc_moments.h"
#include "prefilter/shapes/raster/box_lines.h"

namespace prefilter {
namespace {

bool is_far(const Point2& p) {
  return std::abs(p.x) > kMaxBoxCoordinate || std::abs(p.y) > kMaxBoxCoordinate;
}

bool is_monotone(double a, double b, double c, double d) {
  return (a <= b && b <= c && c <= d) || (a >= b && b >= c && c >= d);
}

// Stores two values; the second may be one past the last.
void store_two(double* to, DoublePair values) { std::memcpy(to, &values, sizeof(values)); }

}  // namespace

// Evaluates the polynomials of a piece at two parameters at once.
template <bool kIsCubic>
class BoxCurves::Values {
 public:
  Values(const CubicPowers& p, const std::array<double, 6>& area) {
    for (int i = 0; i < 4; ++i) p_[i] = pair_of(p[i]);
    for (int i = 0; i < 6; ++i) area_[i] = pair_of(area[i]);
  }
  DoublePair at(DoublePair s) const {
    if constexpr (kIsCubic) return (p_[0] + s * p_[1]) + (s * s) * (p_[2] + s * p_[3]);
    return (p_[0] + s * p_[1]) + (s * s) * p_[2];
  }
  DoublePair area_at(DoublePair s) const {
    const DoublePair squared = s * s;
    DoublePair high = area_[2] + s * area_[3];
    if constexpr (kIsCubic) high += squared * (area_[4] + s * area_[5]);
    return s * ((area_[0] + s * area_[1]) + squared * high);
  }

 private:
  std::array<DoublePair, 4> p_;
  std::array<DoublePair, 6> area_;
};

template <bool kIsCubic>
void BoxCurves::find_rows(const MonotonePolynomials& piece, double low, double high, bool rises) {
  const auto first = static_cast<int>(std::max(std::floor(low) + 1.0, rows_.first_row() + 0.0));
  const auto last = static_cast<int>(std::min(std::ceil(high) - 1.0, rows_.end_row() + 0.0));
  const bool has_low = low >= rows_.first_row();
  const bool has_high = high <= rows_.end_row();
  const int lines = std::max(0, last - first + 1);
  const int place = has_low ? 1 : 0;
  at_rows_.make_room(lines + 3);
  at_rows_.count = place + lines + (has_high ? 1 : 0);
  const double x_end = piece.x[0] + piece.x[1] + piece.x[2] + piece.x[3];
  const double area_end = std::accumulate(piece.area.begin(), piece.area.end(), 0.0);
  const DoublePair column = pair_of(piece.column);
  const DoublePair least_column = pair_of(-DifferenceRows::kMargin);
  const DoublePair most_column = pair_of(rows_.width());
  const auto store_columns = [&](std::int32_t* to, DoublePair x) {
    const IntFour columns = round_to_int(higher(lower(floor(x), most_column), least_column));
    std::memcpy(to, &columns, 2 * sizeof(*to));
  };
  const auto put_end = [&](int at, double y, bool is_end) {
    const double x = is_end ? x_end : piece.x[0];
    const double y_there = is_end ? piece.y[0] + piece.y[1] + piece.y[2] + piece.y[3] : piece.y[0];
    store_columns(&at_rows_.column[at], x + column);
    at_rows_.x[at] = x;
    at_rows_.y[at] = y;
    at_rows_.area[at] = (is_end ? area_end : 0.0) + x * (y - y_there);
  };
  if (has_low) put_end(0, low, !rises);
  if (lines > 0) {
    const DoublePair left = pair_of(std::min(piece.x[0], x_end));
    const DoublePair right = pair_of(std::max(piece.x[0], x_end));
    const MonotoneRoots<kIsCubic> roots(piece.y);
    const Values<kIsCubic> values(piece.x, piece.area);
    DoublePair y = DoublePair{0.0, 1.0} + static_cast<double>(first);
    for (int line = 0; line < lines; line += 2, y += 2.0) {
      const auto [s, miss] = roots(y);
      const DoublePair x = lower(higher(values.at(s), left), right);
      store_two(&at_rows_.x[place + line], x);
      store_columns(&at_rows_.column[place + line], x + column);
      store_two(&at_rows_.y[place + line], y);
      store_two(&at_rows_.area[place + line], values.area_at(s) - x * miss);
    }
  }
  if (has_high) put_end(place + lines, high, rises);
}

template <bool kIsCubic>
void BoxCurves::find_columns(const MonotonePolynomials& piece, int first, int end) {
  if (first >= end) return;
  at_columns_.make_room(end - first + 1);
  const MonotoneRoots<kIsCubic> roots(piece.x);
  const Values<kIsCubic> values(piece.y, piece.area);
  DoublePair x = DoublePair{0.0, 1.0} + (first - piece.column);
  for (int line = 0; line < end - first; line += 2, x += 2.0) {
    const auto [s, miss] = roots(x);
    store_two(&at_columns_.y[line], values.at(s));
    store_two(&at_columns_.area[line], values.area_at(s));
  }
}

void BoxCurves::add(std::span<const Point2> controls, double weight) {
  double low = controls[0].y;
  double high = low;
  for (const Point2& point : controls.subspan(1)) {
    low = std::min(low, point.y);
    high = std::max(high, point.y);
  }
  if (high <= rows_.first_row() || low >= rows_.end_row()) return;
  const bool is_quadratic = controls.size() == 3 && weight == 0.0;
  if (is_quadratic || controls.size() == 4) {
    // A curve is monotone if its control points are.
    const Point2& second = controls[is_quadratic ? 1 : 2];
    const Point2& last = controls.back();
    if (is_monotone(controls[0].x, controls[1].x, second.x, last.x) &&
        is_monotone(controls[0].y, controls[1].y, second.y, last.y)) {
      const bool backward = is_cut_backward(controls);
      std::array<Point2, 4> turned;
      if (backward) {
        std::reverse_copy(controls.begin(), controls.end(), turned.begin());
        controls = {turned.data(), controls.size()};
      }
      add({ParametricCurve(controls, 0.0), 0.0, 1.0, controls.front(), controls.back()},
          backward ? 1 : -1);
      return;
    }
  }
  for_monotone_pieces(controls, weight, [&](const MonotoneCurve& piece, bool backward) {
    add(piece, backward ? 1 : -1);
  });
}

void BoxCurves::add(const MonotoneCurve& piece, int sign) {
  const CurveKind kind = piece.curve.kind;
  if (is_far(piece.begin) || is_far(piece.end) ||
      (kind != CurveKind::kQuadratic && kind != CurveKind::kCubic)) {
    add_cells(piece, sign);
    return;
  }
  const double y_begin = rounded_to_unit(piece.begin.y);
  const double y_end = rounded_to_unit(piece.end.y);
  const bool rises = y_end > y_begin;
  const double low = std::min(y_begin, y_end);
  const double high = std::max(y_begin, y_end);
  if (low == high || high <= rows_.first_row() || low >= rows_.end_row()) return;
  if (std::min(piece.begin.x, piece.end.x) >= rows_.width()) return;

  const MonotonePolynomials polynomial(piece);
  const bool is_cubic = kind == CurveKind::kCubic;
  if (is_cubic) {
    find_rows<true>(polynomial, low, high, rises);
  } else {
    find_rows<false>(polynomial, low, high, rises);
  }
  const int points = at_rows_.count;
  const std::int32_t* columns = at_rows_.column.data();
  const bool x_rises = at_rows_.x[points - 1] >= at_rows_.x[0];
  // The lines between columns that are in the image.
  const int first_line = std::max(std::min(columns[0], columns[points - 1]) + 1, 0);
  const int end_line = std::max(columns[0], columns[points - 1]) + 1;
  if (is_cubic) {
    find_columns<true>(polynomial, first_line, end_line);
  } else {
    find_columns<false>(polynomial, first_line, end_line);
  }

  const double scale = static_cast<double>(1 << kBoxBits) * (rises ? sign : -sign);
  DifferenceRows::Row to = rows_.row(static_cast<int>(std::floor(at_rows_.y[0])));
  for (int i = 0; i + 1 < points; ++i, to = rows_.next(to)) {
    const double y = at_rows_.y[i];
    const double top = at_rows_.y[i + 1];
    const double height = top - y;
    const int column = std::min(columns[i], columns[i + 1]);
    const int end = std::max(columns[i], columns[i + 1]) + 1;
    const std::uint32_t height_steps = to_steps(height * scale);
    const std::uint32_t inside = to_steps(
        (at_rows_.area[i + 1] - at_rows_.area[i] - (column - polynomial.column) * height) * scale);
    to.add_two(column, height_steps - inside, inside);
    for (int line = std::max(column + 1, first_line); line < end; ++line) {
      const int place = line - first_line;
      const double ahead = at_columns_.y[place];
      const double to_line = line - polynomial.column;
      const double beyond =
          x_rises ? at_rows_.area[i + 1] - at_columns_.area[place] - to_line * (top - ahead)
                  : at_columns_.area[place] - at_rows_.area[i] - to_line * (ahead - y);
      const std::uint32_t steps = to_steps(beyond * scale);
      to.add(line - 1, steps);
      to.add_two(line, 0U - 2U * steps, steps);
    }
  }
}

// Adds conics and distant curves cell by cell.
void BoxCurves::add_cells(const MonotoneCurve& piece, int sign) {
  const GridWindow window{0, rows_.width(), rows_.first_row(), rows_.end_row()};
  const auto in_cell = [&](int column, int row, const CellArc& arc) {
    const Point2 center{column + 0.5, row + 0.5};
    ArcMoments<0> cell;
    if (piece.curve.kind == CurveKind::kLine) {
      cell_.assign(1, {});
      batch_.add_line(arc.begin - center, arc.end - center, sign, 0, &cell_);
      batch_.flush(&cell_);
      cell = cell_[0];
    } else {
      ArcBatch<0>::add_inside(piece.curve, arc, center, sign, &cell);
    }
    const double steps = (rounded_to_unit(arc.end.y) - rounded_to_unit(arc.begin.y)) / kBoxUnit;
    const std::int32_t height = sign * static_cast<std::int32_t>(steps);
    const auto part = static_cast<std::uint32_t>(cell.inside(0, 0) + height / 2);
    rows_.row(row).add_two(column, static_cast<std::uint32_t>(height) - part, part);
  };
  const auto left_of_window = [&](int row, double y_begin, double y_end) {
    rows_.row(row).add(
        -1, to_steps(sign * (rounded_to_unit(y_end) - rounded_to_unit(y_begin)) * (1 << kBoxBits)));
  };
  cut_to_cells(piece, window, in_cell, left_of_window);
}

}  // namespace prefilter
