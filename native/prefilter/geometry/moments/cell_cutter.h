// SPDX-License-Identifier: GPL-3.0-or-later

// Cuts monotone curves along the lines of a grid of unit cells.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "prefilter/geometry/moments/monotone_curve.h"

namespace prefilter {

/// The cells [first_column, end_column) x [first_row, end_row) of a grid.
struct GridWindow {
  int first_column = 0;
  int end_column = 0;
  int first_row = 0;
  int end_row = 0;
};

/// The part of a curve in one cell, in the order of its parameter. At crossings of grid lines its
/// coordinate is exactly the line's.
struct CellArc {
  double t_begin = 0.0;
  double t_end = 1.0;
  Point2 begin;
  Point2 end;
};

/// Cuts a curve into the cells of a window. Calls in_cell(column, row, arc) for each cell that it
/// passes, and left_of_window(row, y_begin, y_end) for parts left of the window. Parts to the
/// right, above or below are dropped, and so are horizontal curves, which contribute nothing to
/// integrals over y.
template <typename InCell, typename LeftOfWindow>
void cut_to_cells(const MonotoneCurve& piece, const GridWindow& window, const InCell& in_cell,
                  const LeftOfWindow& left_of_window);

/// The same for a line, starting at its lower end, which is faster: calls in_cell(column, row,
/// begin, end).
template <typename InCell, typename LeftOfWindow>
void cut_line_to_cells(Point2 begin, Point2 end, const GridWindow& window, const InCell& in_cell,
                       const LeftOfWindow& left_of_window);

/// The same for any curve that rises from `begin` to `end`, given by x_at(y) and y_at(x); x_at()
/// stays between both ends.
template <typename XAt, typename YAt, typename InCell, typename LeftOfWindow>
void cut_rising_to_cells(Point2 begin, Point2 end, const XAt& x_at, const YAt& y_at,
                         const GridWindow& window, const InCell& in_cell,
                         const LeftOfWindow& left_of_window);

namespace internal {

// The cell in which a curve continues from a coordinate, rising or falling.
inline int cell_at(double value, bool rises) {
  return static_cast<int>(rises ? std::floor(value) : std::ceil(value) - 1.0);
}

// The column, clamped to first_column - 1 left of the window and end_column right of it.
inline int column_at(double x, bool rises, const GridWindow& window) {
  if (x < window.first_column) return window.first_column - 1;
  if (x > window.end_column) return window.end_column;
  return std::clamp(cell_at(x, rises), window.first_column - 1, window.end_column);
}

// A curve and its directions, with shortcuts for lines.
struct CurveCursor {
  explicit CurveCursor(const MonotoneCurve& monotone)
      : piece(monotone),
        is_line(monotone.curve.kind == CurveKind::kLine),
        x_rises(monotone.end.x >= monotone.begin.x),
        y_rises(monotone.end.y > monotone.begin.y),
        begin(monotone.begin),
        slope(monotone.end - monotone.begin) {}

  double parameter_at_x(double value, double low) const {
    return is_line ? (value - begin.x) / slope.x : crossing(piece, 0, value, low);
  }
  double parameter_at_y(double value, double low) const {
    return is_line ? (value - begin.y) / slope.y : crossing(piece, 1, value, low);
  }
  double x_at(double t) const { return is_line ? begin.x + t * slope.x : piece.curve.at(t).x; }
  double y_at(double t) const { return is_line ? begin.y + t * slope.y : piece.curve.at(t).y; }

  const MonotoneCurve& piece;
  bool is_line;
  bool x_rises;
  bool y_rises;
  Point2 begin;
  Point2 slope;
};

// The point where the curve enters the window's rows.
inline CellArc first_arc(const CurveCursor& cursor, const GridWindow& window) {
  CellArc arc{cursor.piece.t_begin, cursor.piece.t_begin, cursor.begin, cursor.begin};
  if (cursor.y_rises ? arc.begin.y < window.first_row : arc.begin.y > window.end_row) {
    arc.begin.y = cursor.y_rises ? window.first_row : window.end_row;
    arc.t_begin = cursor.parameter_at_y(arc.begin.y, arc.t_begin);
    arc.begin.x = cursor.x_at(arc.t_begin);
  }
  return arc;
}

// Ends an arc at the first grid line: at next.x, reached at parameter t_x, or at next.y, reached at
// t_y.
inline void end_at_line(const CurveCursor& cursor, double t_x, double t_y, const Point2& next,
                        CellArc* arc) {
  arc->t_end = std::min(t_x, t_y);
  const Point2& begin = arc->begin;
  if (t_x <= t_y) {
    arc->end.x = next.x;
  } else {
    const double x = cursor.x_at(t_y);
    arc->end.x = cursor.x_rises ? std::clamp(x, begin.x, std::max(begin.x, next.x))
                                : std::clamp(x, std::min(begin.x, next.x), begin.x);
  }
  if (t_y <= t_x) {
    arc->end.y = next.y;
  } else {
    const double y = cursor.y_at(t_x);
    arc->end.y = cursor.y_rises ? std::clamp(y, begin.y, next.y) : std::clamp(y, next.y, begin.y);
  }
}

}  // namespace internal

template <typename InCell, typename LeftOfWindow>
void cut_to_cells(const MonotoneCurve& piece, const GridWindow& window, const InCell& in_cell,
                  const LeftOfWindow& left_of_window) {
  const Point2 end = piece.end;
  if (piece.begin.y == end.y) return;
  const internal::CurveCursor cursor(piece);
  const bool x_rises = cursor.x_rises;
  const bool y_rises = cursor.y_rises;
  if (std::max(piece.begin.y, end.y) <= window.first_row) return;
  if (std::min(piece.begin.y, end.y) >= window.end_row) return;
  if (std::min(piece.begin.x, end.x) >= window.end_column) return;

  constexpr double kNever = std::numeric_limits<double>::infinity();
  CellArc arc = internal::first_arc(cursor, window);
  const int left = window.first_column - 1;
  int column = internal::column_at(arc.begin.x, x_rises, window);
  int row = internal::cell_at(arc.begin.y, y_rises);
  const int row_after_last = y_rises ? window.end_row : window.first_row - 1;
  double t_x = -1.0;
  double t_y = -1.0;
  for (;;) {
    const Point2 next{static_cast<double>(x_rises ? column + 1 : column),
                      static_cast<double>(y_rises ? row + 1 : row)};
    if (t_x < 0.0) {
      const bool crosses = x_rises ? column < window.end_column && next.x < end.x
                                   : column >= window.first_column && next.x > end.x;
      t_x = crosses ? cursor.parameter_at_x(next.x, arc.t_begin) : kNever;
    }
    if (t_y < 0.0) {
      const bool crosses = y_rises ? next.y < end.y : next.y > end.y;
      t_y = crosses ? cursor.parameter_at_y(next.y, arc.t_begin) : kNever;
    }
    const bool is_last = t_x == kNever && t_y == kNever;
    if (is_last) {
      arc.t_end = piece.t_end;
      arc.end = end;
    } else {
      internal::end_at_line(cursor, t_x, t_y, next, &arc);
    }
    if (column == left) {
      left_of_window(row, arc.begin.y, arc.end.y);
    } else if (column < window.end_column) {
      in_cell(column, row, arc);
    }
    if (is_last) return;
    const bool passes_x = t_x <= t_y;
    const bool passes_y = t_y <= t_x;
    if (passes_y) row += y_rises ? 1 : -1;
    if (row == row_after_last) return;
    if (passes_x) column += x_rises ? 1 : -1;
    if (x_rises && column == window.end_column) return;
    if (passes_x) t_x = -1.0;
    if (passes_y) t_y = -1.0;
    arc.t_begin = arc.t_end;
    arc.begin = arc.end;
  }
}

template <typename XAt, typename YAt, typename InCell, typename LeftOfWindow>
void cut_rising_to_cells(Point2 begin, Point2 end, const XAt& x_at, const YAt& y_at,
                         const GridWindow& window, const InCell& in_cell,
                         const LeftOfWindow& left_of_window) {
  if (!(begin.y < end.y)) return;
  if (end.y <= window.first_row || begin.y >= window.end_row) return;
  if (std::min(begin.x, end.x) >= window.end_column) return;
  const bool x_rises = end.x >= begin.x;
  const int left = window.first_column - 1;
  Point2 from = begin;
  if (from.y < window.first_row)
    from = {x_at(window.first_row), static_cast<double>(window.first_row)};
  int row = static_cast<int>(std::floor(from.y));
  int column = internal::column_at(from.x, x_rises, window);
  const double y_end = std::min(end.y, static_cast<double>(window.end_row));
  while (from.y < y_end) {
    Point2 to{end.x, end.y};
    if (row + 1 < end.y) to = {x_at(row + 1), row + 1.0};
    // Steps through the columns within the row.
    const int step = x_rises ? 1 : -1;
    for (;;) {
      const double line = x_rises ? column + 1 : column;
      const bool passes = x_rises ? column < window.end_column && line < to.x
                                  : column >= window.first_column && line > to.x;
      if (!passes) break;
      const Point2 at{line, std::clamp(y_at(line), from.y, to.y)};
      if (column == left) {
        left_of_window(row, from.y, at.y);
      } else if (column < window.end_column) {
        in_cell(column, row, from, at);
      }
      from = at;
      column += step;
    }
    if (column == left) {
      left_of_window(row, from.y, to.y);
    } else if (column < window.end_column) {
      in_cell(column, row, from, to);
    } else if (x_rises) {
      return;
    }
    from = to;
    ++row;
  }
}

template <typename InCell, typename LeftOfWindow>
void cut_line_to_cells(Point2 begin, Point2 end, const GridWindow& window, const InCell& in_cell,
                       const LeftOfWindow& left_of_window) {
  const double slope = (end.x - begin.x) / (end.y - begin.y);
  const double rise = (end.y - begin.y) / (end.x - begin.x);
  const double x_low = std::min(begin.x, end.x);
  const double x_high = std::max(begin.x, end.x);
  cut_rising_to_cells(
      begin, end,
      [&](double y) { return std::clamp(begin.x + (y - begin.y) * slope, x_low, x_high); },
      [&](double x) { return begin.y + (x - begin.x) * rise; }, window, in_cell, left_of_window);
}

}  // namespace prefilter
