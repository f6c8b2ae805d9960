// SPDX-License-Identifier: GPL-3.0-or-later

// Monotone curves cut along the lines of a grid of unit cells.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "prefilter/moments/monotone_curve.h"

namespace prefilter {

/// The cells [first_column, end_column) x [first_row, end_row) of a grid.
struct GridWindow {
  int first_column = 0;
  int end_column = 0;
  int first_row = 0;
  int end_row = 0;
};

/// What a curve leaves in one cell, in the order of its parameter. Where it crosses a line of the
/// grid its coordinate is exactly the line's.
struct CellArc {
  double t_begin = 0.0;
  double t_end = 1.0;
  Point2 begin;
  Point2 end;
};

/// Cuts a piece to the cells of a window: calls in_cell(column, row, arc) for each one that it
/// passes, and left_of_window(row, y_begin, y_end) for what lies left of the window. What lies
/// right of it, above or below is left out; so is what is level, as no integral over y sees it.
template <typename InCell, typename LeftOfWindow>
void cut_to_cells(const MonotoneCurve& piece, const GridWindow& window, const InCell& in_cell,
                  const LeftOfWindow& left_of_window);

/// The same for a line, from its lower end, which is quicker: calls in_cell(column, row, begin,
/// end).
template <typename InCell, typename LeftOfWindow>
void cut_line_to_cells(Point2 begin, Point2 end, const GridWindow& window, const InCell& in_cell,
                       const LeftOfWindow& left_of_window);

namespace internal {

// The cell that a curve is in at a coordinate, from where it goes on rising or falling.
inline int cell_at(double value, bool rises) {
  return static_cast<int>(rises ? std::floor(value) : std::ceil(value) - 1.0);
}

}  // namespace internal

template <typename InCell, typename LeftOfWindow>
void cut_to_cells(const MonotoneCurve& piece, const GridWindow& window, const InCell& in_cell,
                  const LeftOfWindow& left_of_window) {
  const Point2 end = piece.end;
  if (piece.begin.y == end.y) return;
  const bool x_rises = end.x >= piece.begin.x;
  const bool y_rises = end.y > piece.begin.y;
  const double y_low = y_rises ? piece.begin.y : end.y;
  const double y_high = y_rises ? end.y : piece.begin.y;
  if (y_high <= window.first_row || y_low >= window.end_row) return;
  if (std::min(piece.begin.x, end.x) >= window.end_column) return;

  const bool is_line = piece.curve.kind == CurveKind::kLine;
  const Point2 line_begin = piece.begin;
  const Point2 line_slope = piece.end - piece.begin;
  const auto pass_x = [&](double value, double low) {
    return is_line ? (value - line_begin.x) / line_slope.x : crossing(piece, 0, value, low);
  };
  const auto pass_y = [&](double value, double low) {
    return is_line ? (value - line_begin.y) / line_slope.y : crossing(piece, 1, value, low);
  };
  const auto x_at = [&](double t) {
    return is_line ? line_begin.x + t * line_slope.x : piece.curve.at(t).x;
  };
  const auto y_at = [&](double t) {
    return is_line ? line_begin.y + t * line_slope.y : piece.curve.at(t).y;
  };

  CellArc arc{piece.t_begin, piece.t_begin, piece.begin, piece.begin};
  if (y_rises ? arc.begin.y < window.first_row : arc.begin.y > window.end_row) {
    arc.begin.y = y_rises ? window.first_row : window.end_row;
    arc.t_begin = pass_y(arc.begin.y, arc.t_begin);
    arc.begin.x = x_at(arc.t_begin);
  }
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const int left = window.first_column - 1;
  int column;
  if (arc.begin.x < window.first_column) {
    column = left;
  } else if (arc.begin.x > window.end_column) {
    column = window.end_column;
  } else {
    column = std::clamp(internal::cell_at(arc.begin.x, x_rises), left, window.end_column);
  }
  int row = internal::cell_at(arc.begin.y, y_rises);
  const int row_after_last = y_rises ? window.end_row : window.first_row - 1;
  double t_x = -1.0;
  double t_y = -1.0;
  for (;;) {
    const double next_x = x_rises ? column + 1 : column;
    const double next_y = y_rises ? row + 1 : row;
    if (t_x < 0.0) {
      const bool there_is = x_rises ? column < window.end_column && next_x < end.x
                                    : column >= window.first_column && next_x > end.x;
      t_x = there_is ? pass_x(next_x, arc.t_begin) : kNever;
    }
    if (t_y < 0.0) {
      const bool there_is = y_rises ? next_y < end.y : next_y > end.y;
      t_y = there_is ? pass_y(next_y, arc.t_begin) : kNever;
    }
    int column_step = 0;
    int row_step = 0;
    if (t_x == kNever && t_y == kNever) {
      arc.t_end = piece.t_end;
      arc.end = end;
    } else {
      arc.t_end = std::min(t_x, t_y);
      if (t_x <= t_y) {
        arc.end.x = next_x;
        column_step = x_rises ? 1 : -1;
      } else {
        const double x = x_at(t_y);
        arc.end.x = x_rises ? std::clamp(x, arc.begin.x, std::max(arc.begin.x, next_x))
                            : std::clamp(x, std::min(arc.begin.x, next_x), arc.begin.x);
      }
      if (t_y <= t_x) {
        arc.end.y = next_y;
        row_step = y_rises ? 1 : -1;
      } else {
        const double y = y_at(t_x);
        arc.end.y =
            y_rises ? std::clamp(y, arc.begin.y, next_y) : std::clamp(y, next_y, arc.begin.y);
      }
    }
    if (column == left) {
      left_of_window(row, arc.begin.y, arc.end.y);
    } else if (column < window.end_column) {
      in_cell(column, row, arc);
    }
    if (column_step == 0 && row_step == 0) return;
    row += row_step;
    if (row == row_after_last) return;
    column += column_step;
    if (x_rises && column == window.end_column) return;
    if (column_step != 0) t_x = -1.0;
    if (row_step != 0) t_y = -1.0;
    arc.t_begin = arc.t_end;
    arc.begin = arc.end;
  }
}

template <typename InCell, typename LeftOfWindow>
void cut_line_to_cells(Point2 begin, Point2 end, const GridWindow& window, const InCell& in_cell,
                       const LeftOfWindow& left_of_window) {
  if (!(begin.y < end.y)) return;
  if (end.y <= window.first_row || begin.y >= window.end_row) return;
  if (std::min(begin.x, end.x) >= window.end_column) return;
  const bool x_rises = end.x >= begin.x;
  const double slope = (end.x - begin.x) / (end.y - begin.y);
  const double rise = (end.y - begin.y) / (end.x - begin.x);
  const double x_low = std::min(begin.x, end.x);
  const double x_high = std::max(begin.x, end.x);
  const auto x_at = [&](double y) {
    return std::clamp(begin.x + (y - begin.y) * slope, x_low, x_high);
  };
  const int left = window.first_column - 1;
  const auto column_at = [&](double x) {
    if (x < window.first_column) return left;
    if (x > window.end_column) return window.end_column;
    return std::clamp(internal::cell_at(x, x_rises), left, window.end_column);
  };
  Point2 from = begin;
  if (from.y < window.first_row)
    from = {x_at(window.first_row), static_cast<double>(window.first_row)};
  int row = static_cast<int>(std::floor(from.y));
  int column = column_at(from.x);
  const double y_end = std::min(end.y, static_cast<double>(window.end_row));
  while (from.y < y_end) {
    Point2 to{end.x, end.y};
    if (row + 1 < end.y) to = {x_at(row + 1), row + 1.0};
    // From column to column within the row.
    const int step = x_rises ? 1 : -1;
    for (;;) {
      const double line = x_rises ? column + 1 : column;
      const bool passes = x_rises ? column < window.end_column && line < to.x
                                  : column >= window.first_column && line > to.x;
      if (!passes) break;
      const Point2 at{line, std::clamp(begin.y + (line - begin.x) * rise, from.y, to.y)};
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

}  // namespace prefilter
