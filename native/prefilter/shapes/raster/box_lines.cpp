// SPDX-License-Identifier: GPL-3.0-or-later

// Section 2.2 for lines and the box filter.
//
// In one row, let x run along a line from L to R while y rises by d, and let i be the column of L.
// Let E_k be the integral over y of the distance by which x exceeds the left side of column i + k.
// The coverage of pixel i + k is d - E_k + E_(k + 1). For a line, E_k is c (R - i - k)^2 with c = 1
// / (2 |slope|), and E_0 is d (L + R - 2 i) / 2. Each E_k is rounded once, so the pixels of a row
// add up to d exactly.

#include "prefilter/shapes/raster/box_lines.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace prefilter {
namespace {

// Columns per row. A steeper line counts as vertical, and its c is not used.
constexpr double kMinSlope = 1e-9;

double half_over(double slope) { return 0.5 / std::max(std::abs(slope), kMinSlope); }

}  // namespace

void BoxLines::begin_at(const Point2& point) {
  constexpr double kScale = kOne;
  cell_ = floor(DoublePair{point.x, point.y});
  const IntFour place = round_to_int((DoublePair{point.x, point.y} - cell_) * kScale);
  x_ = place[0];
  y_ = place[1];
  begin_y_ = y_;
}

void BoxLines::flush() {
  const std::uint32_t height = y_ - begin_y_;
  const auto part = static_cast<std::uint32_t>(part_);
  if (height == 0 && part == 0) return;
  begin_y_ = y_;
  part_ = 0;
  const auto row = static_cast<int>(cell_[1]);
  if (row < rows_.first_row() || row >= rows_.end_row()) return;
  const auto column = static_cast<int>(cell_[0]);
  if (column >= rows_.width()) return;
  // A falling line adds the region on its right.
  rows_.row(row).add_two(rows_.clamped(column), part - height, 0U - part);
}

void BoxLines::leave_cell(const Point2& point) {
  const Point2 from{cell_[0] + x_ * kBoxUnit, cell_[1] + y_ * kBoxUnit};
  flush();
  const Point2 to{rounded_to_unit(point.x), rounded_to_unit(point.y)};
  begin_at(to);
  if (from.y < to.y) {
    add_line(from, to, -static_cast<double>(kOne));
  } else if (from.y > to.y) {
    add_line(to, from, kOne);
  }
}

std::size_t BoxLines::lines_to(const Point2* points, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (stays_in_cell(points[i])) continue;
    if (!(std::abs(points[i].x) <= kMaxBoxCoordinate &&
          std::abs(points[i].y) <= kMaxBoxCoordinate)) {
      return i;
    }
    leave_cell(points[i]);
  }
  return count;
}

void BoxLines::add_line(Point2 low, Point2 high, double scale) {
  const double first_row = rows_.first_row();
  const double end_row = rows_.end_row();
  const double width = rows_.width();
  if (high.y <= first_row || low.y >= end_row) return;
  const double left = std::min(low.x, high.x);
  const double right = std::max(low.x, high.x);
  if (left >= width) return;
  const double slope = (high.x - low.x) / (high.y - low.y);
  double begin = std::max(low.y, first_row);
  double end = std::min(high.y, end_row);
  if (right <= 0.0) {
    add_left(begin, end, scale);
    return;
  }
  // Rows in which the line is outside the image, with a margin of a row for rounding, need no
  // cutting.
  const auto row_at = [&](double x) {
    return std::floor(std::clamp(low.y + (x - low.x) / slope, begin, end));
  };
  if (left < 0.0) {
    const double pass = row_at(0.0);
    if (slope > 0.0) {
      const double to = std::max(pass - 1.0, begin);
      add_left(begin, to, scale);
      begin = to;
    } else {
      const double from = std::min(pass + 2.0, end);
      add_left(from, end, scale);
      end = from;
    }
  }
  if (right > width && begin < end) {
    const double pass = row_at(width);
    if (slope > 0.0) {
      end = std::min(end, pass + 2.0);
    } else {
      begin = std::max(begin, pass - 1.0);
    }
  }
  const double reach = std::min(std::abs(slope), right - left);
  if (reach <= 1.0) {
    add_narrow<2>(low, slope, begin, end, scale);
  } else if (reach <= 2.0) {
    add_narrow<3>(low, slope, begin, end, scale);
  } else {
    add_wide(low, slope, begin, end, scale);
  }
}

void BoxLines::add_left(double from, double to, double scale) {
  const double full_from = std::min(std::ceil(from), to);
  const double full_to = std::max(std::floor(to), full_from);
  const auto sign = scale > 0.0 ? 1U : ~0U;
  const auto add_part = [&](double part_from, double part_to) {
    if (part_from >= part_to) return;
    rows_.row(static_cast<int>(std::floor(part_from)))
        .add(-1, to_steps((part_to - part_from) * scale));
  };
  add_part(from, full_from);
  rows_.add_rows(static_cast<int>(full_from), static_cast<int>(full_to), sign * kOne);
  add_part(full_to, to);
}

namespace {

// A line's part in two rows.
struct RowPair {
  IntFour column;
  IntFour height;
  IntFour inside;   // E_0
  IntFour beyond;   // E_1
  IntFour farther;  // E_2
};

// A rising line, with its values duplicated for the two rows of a pair.
struct NarrowLine {
  NarrowLine(const Point2& low, double slope, double begin, double end, double scale, int width)
      : c(pair_of(half_over(slope) * scale)),
        least(pair_of(-DifferenceRows::kMargin)),
        most(pair_of(width)),
        low_x(pair_of(low.x)),
        low_y(pair_of(low.y)),
        slopes(pair_of(slope)),
        begins(pair_of(begin)),
        ends(pair_of(end)),
        half_scale(pair_of(0.5 * scale)),
        full_height(joined(round_to_int(pair_of(scale)), round_to_int(pair_of(scale)))) {}

  // At most kColumns columns in each row. `is_full`: the line passes both rows from bottom to top.
  template <int kColumns, bool is_full>
  RowPair rows_at(DoublePair y) const {
    RowPair out;
    DoublePair from = y;
    DoublePair to = y + 1.0;
    DoublePair half_height = half_scale;
    out.height = full_height;
    if constexpr (!is_full) {
      from = higher(from, begins);
      to = higher(lower(to, ends), from);
      half_height = (to - from) * half_scale;
      out.height = round_to_int(half_height + half_height);
    }
    const DoublePair x_from = low_x + (from - low_y) * slopes;
    const DoublePair x_to = low_x + (to - low_y) * slopes;
    const DoublePair left = lower(x_from, x_to);
    const DoublePair column = floor(left);
    const DoublePair right = higher(x_from, x_to) - column;
    const DoublePair zero{};
    const DoublePair beyond = higher(right - 1.0, zero);
    out.column = round_to_int(lower(higher(column, least), most));
    out.inside = round_to_int((left - column + right) * half_height);
    out.beyond = round_to_int(c * beyond * beyond);
    if constexpr (kColumns > 2) {
      const DoublePair farther = higher(right - 2.0, zero);
      out.farther = round_to_int(c * farther * farther);
    }
    return out;
  }

  DoublePair c;
  DoublePair least;  // columns
  DoublePair most;
  DoublePair low_x;
  DoublePair low_y;
  DoublePair slopes;
  DoublePair begins;
  DoublePair ends;
  DoublePair half_scale;
  IntFour full_height;
};

}  // namespace

// Adds a line that crosses at most kColumns columns in each row: four differences per row, four
// rows at once.
template <int kColumns>
void BoxLines::add_narrow(const Point2& low, double slope, double begin, double end, double scale) {
  const NarrowLine line(low, slope, begin, end, scale, rows_.width());
  const auto first_row = static_cast<int>(std::floor(begin));
  const auto end_row = static_cast<int>(std::ceil(end));
  DifferenceRows::Row to = rows_.row(first_row);
  const DifferenceRows::Row second = rows_.next(to);
  const std::ptrdiff_t stride = second.steps - to.steps;
  const std::ptrdiff_t mark_stride = second.marks - to.marks;
  const auto four_rows = [&](DoublePair y, auto is_full) {
    const RowPair a = line.rows_at<kColumns, is_full>(y);
    const RowPair b = line.rows_at<kColumns, is_full>(y + 2.0);
    const IntFour column = joined(a.column, b.column);
    const IntFour height = is_full ? line.full_height : joined(a.height, b.height);
    const IntFour e0 = joined(a.inside, b.inside);
    const IntFour e1 = joined(a.beyond, b.beyond);
    IntFour s0 = height - e0 + e1;
    IntFour s1 = e0 - e1 - e1;
    IntFour s2 = e1;
    IntFour s3{};
    if constexpr (kColumns > 2) {
      s3 = joined(a.farther, b.farther);
      s1 += s3;
      s2 -= s3 + s3;
    }
    const IntFour s01_low = shuffle<0, 4, 1, 5>(s0, s1);
    const IntFour s01_high = shuffle<2, 6, 3, 7>(s0, s1);
    const IntFour s23_low = shuffle<0, 4, 1, 5>(s2, s3);
    const IntFour s23_high = shuffle<2, 6, 3, 7>(s2, s3);
    const auto add = [&](int k, IntFour steps) {
      to.add_four(static_cast<std::int32_t>(column[k]), steps);
      to = {to.steps + stride, to.marks + mark_stride};
    };
    add(0, shuffle<0, 1, 4, 5>(s01_low, s23_low));
    add(1, shuffle<2, 3, 6, 7>(s01_low, s23_low));
    add(2, shuffle<0, 1, 4, 5>(s01_high, s23_high));
    add(3, shuffle<2, 3, 6, 7>(s01_high, s23_high));
  };
  DoublePair y = DoublePair{0.0, 1.0} + static_cast<double>(first_row);
  for (int row = first_row; row < end_row; row += 4, y += 4.0) {
    if (row >= begin && row + 4 <= end) {
      four_rows(y, std::true_type{});
    } else {
      four_rows(y, std::false_type{});
    }
  }
}

void BoxLines::add_wide(const Point2& low, double slope, double begin, double end, double scale) {
  const double c = half_over(slope) * scale;
  const auto first_row = static_cast<int>(std::floor(begin));
  const auto end_row = static_cast<int>(std::ceil(end));
  const int width = rows_.width();
  DifferenceRows::Row to_row = rows_.row(first_row);
  for (int row = first_row; row < end_row; ++row, to_row = rows_.next(to_row)) {
    const double from = std::max<double>(row, begin);
    const double to = std::min(row + 1.0, end);
    const double x_from = low.x + (from - low.y) * slope;
    const double x_to = low.x + (to - low.y) * slope;
    const double left = std::min(x_from, x_to);
    const double right = std::max(x_from, x_to);
    const double first = std::floor(left);
    if (first >= width) continue;
    const std::uint32_t height = to_steps((to - from) * scale);
    // Starts at the first column in the image, or at the line's last column.
    constexpr double kMinColumn = -DifferenceRows::kMargin;
    const double last = std::floor(right);
    const auto begin_column = static_cast<int>(std::max({first, std::min(last, -1.0), kMinColumn}));
    const auto end_column = static_cast<int>(std::min<double>(std::max(last, kMinColumn), width));
    const double inside = (left - first + (right - first)) * 0.5 * (to - from) * scale;
    const double first_beyond = right - begin_column;
    std::uint32_t beyond =
        to_steps(begin_column > first ? c * first_beyond * first_beyond : inside);
    std::uint32_t covered = 0;
    double r = first_beyond - 1.0;
    for (int column = begin_column; column < end_column; ++column, r -= 1.0) {
      const std::uint32_t next = to_steps(c * r * r);
      const std::uint32_t here = height - beyond + next;
      to_row.steps[column] += here - covered;
      covered = here;
      beyond = next;
    }
    to_row.steps[end_column] += height - beyond - covered;
    to_row.steps[end_column + 1] += beyond;
    to_row.mark(begin_column, end_column + 1);
  }
}

}  // namespace prefilter
