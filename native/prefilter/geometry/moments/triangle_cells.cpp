// SPDX-License-Identifier: GPL-3.0-or-later

// Cuts triangles by section 7.2, so that the image of each piece lies in one cell. The moments of a
// piece are closed forms, summed over its triangle fan.
#include "prefilter/geometry/moments/triangle_cells.h"

#include <algorithm>
#include <cassert>

#include "prefilter/base/vectors.h"

namespace prefilter {
namespace {

// x and y.
using XyPair = Vector<double, 2>;

XyPair swapped(XyPair v) { return XyPair{v[1], v[0]}; }
double sum(XyPair v) { return v[0] + v[1]; }

// Coefficients of s^a t^b, with a and b in {0, 1, 2}, of a product of power series 1 / (1 - s x - t
// y), one for each of several points (x, y). Coefficients that are exchanged with x and y are
// stored in pairs.
struct PointSeries {
  double c00;
  XyPair c10_01;
  XyPair c20_02;
  double c11;
  XyPair c21_12;
  double c22;
};

PointSeries series_of(XyPair point) {
  const double xy = point[0] * point[1];
  return {1.0, point, point * point, 2.0 * xy, 3.0 * xy * point, 6.0 * xy * xy};
}

// Division by 1 - s x - t y is a recurrence: each coefficient gets x times the preceding new one in
// s, plus y times the preceding one in t.
PointSeries with_point(PointSeries series, XyPair point) {
  series.c10_01 += series.c00 * point;
  series.c20_02 += point * series.c10_01;
  series.c11 += sum(point * swapped(series.c10_01));
  series.c21_12 += point * series.c11 + swapped(point) * series.c20_02;
  series.c22 += sum(point * swapped(series.c21_12));
  return series;
}

void add(double factor, const PointSeries& series, PointSeries* to) {
  to->c00 += factor * series.c00;
  to->c10_01 += factor * series.c10_01;
  to->c20_02 += factor * series.c20_02;
  to->c11 += factor * series.c11;
  to->c21_12 += factor * series.c21_12;
  to->c22 += factor * series.c22;
}

// The mean of x^a y^b over a triangle is 2 a! b! / (a + b + 2)! times the coefficient of s^a t^b in
// the product for its corners: with barycentric coordinates b_i, (s x + t y)^n = (sum_i b_i (s x_i
// + t y_i))^n, and the mean of b_0^i b_1^j b_2^k is 2 i! j! k! / (i + j + k + 2)!, which cancels
// the multinomial coefficients.
void add_means(const PointSeries& series, WeightMoments* moments) {
  (*moments)[0] += series.c00;
  (*moments)[1] += series.c10_01[0] * (1.0 / 3.0);
  (*moments)[2] += series.c20_02[0] * (1.0 / 6.0);
  (*moments)[3] += series.c10_01[1] * (1.0 / 3.0);
  (*moments)[4] += series.c11 * (1.0 / 12.0);
  (*moments)[5] += series.c21_12[0] * (1.0 / 30.0);
  (*moments)[6] += series.c20_02[1] * (1.0 / 6.0);
  (*moments)[7] += series.c21_12[1] * (1.0 / 30.0);
  (*moments)[8] += series.c22 * (1.0 / 90.0);
}

double coordinate(const GridPoint& corner, int axis) { return axis == 0 ? corner.x : corner.y; }

double twice_area(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return std::abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
}

GridPoint between(const GridPoint& p, const GridPoint& q, double f) {
  return {p.x + f * (q.x - p.x), p.y + f * (q.y - p.y)};
}

// Adds the point on the edge from corner i to corner k with exactly `value` as its coordinate along
// `axis` to both parts. It is computed from the same end for both directions of the edge, so that
// triangles sharing the edge agree.
void add_crossing(const CellPiece& piece, int i, int k, int axis, double value, CellPiece* low,
                  CellPiece* high) {
  if (coordinate(piece.corners[i], axis) > coordinate(piece.corners[k], axis)) std::swap(i, k);
  const GridPoint& p = piece.corners[i];
  const GridPoint& q = piece.corners[k];
  const double f = (value - coordinate(p, axis)) / (coordinate(q, axis) - coordinate(p, axis));
  GridPoint at = between(p, q, f);
  (axis == 0 ? at.x : at.y) = value;
  if (piece.is_barycentric) {
    low->sources[low->count] = high->sources[high->count] =
        between(piece.sources[i], piece.sources[k], f);
  }
  low->corners[low->count++] = at;
  high->corners[high->count++] = at;
}

void add_corner(const CellPiece& piece, int i, CellPiece* to) {
  if (piece.is_barycentric) to->sources[to->count] = piece.sources[i];
  to->corners[to->count++] = piece.corners[i];
}

struct Range {
  double low, high;
};

Range extent(const CellPiece& piece, int axis) {
  Range range{coordinate(piece.corners[0], axis), coordinate(piece.corners[0], axis)};
  for (int i = 1; i < piece.count; ++i) {
    range.low = std::min(range.low, coordinate(piece.corners[i], axis));
    range.high = std::max(range.high, coordinate(piece.corners[i], axis));
  }
  return range;
}

// Clips a piece to [low, high] along an axis.
void keep_between(CellPiece* piece, int axis, double low, double high) {
  const Range range = extent(*piece, axis);
  CellPiece inside;
  CellPiece outside;
  if (range.low < low) {
    split_piece(*piece, axis, low, &outside, &inside);
    *piece = inside;
  }
  if (range.high > high) {
    split_piece(*piece, axis, high, &inside, &outside);
    *piece = inside;
  }
}

// The cells of a row inside a piece that was clipped to the row. The piece is convex, so it
// contains the rectangle between the larger of its left ends and the smaller of its right ends on
// the row's two sides.
CellSpan full_cells(const CellPiece& row, int y) {
  const double sides[2] = {static_cast<double>(y), static_cast<double>(y + 1)};
  double left = -HUGE_VAL;
  double right = HUGE_VAL;
  for (const double side : sides) {
    double side_left = HUGE_VAL;
    double side_right = -HUGE_VAL;
    for (int i = 0; i < row.count; ++i) {
      if (row.corners[i].y != side) continue;
      side_left = std::min(side_left, row.corners[i].x);
      side_right = std::max(side_right, row.corners[i].x);
    }
    left = std::max(left, side_left);
    right = std::min(right, side_right);
  }
  if (!(right - left >= 1.0)) return {0, -1};
  return {static_cast<int>(std::ceil(left)), static_cast<int>(std::floor(right)) - 1};
}

void add_if_massive(int x, int y, const CellPiece& piece, CellSink* sink) {
  if (piece.mass() > 0.0) sink->add_piece(x, y, piece);
}

// Sends a piece in row y with the extent `range` to the sink, column by column.
void sweep_columns(const CellPiece& row, int y, const Range& range, const CellWindow& window,
                   CellSink* sink) {
  const CellSpan span = cell_span(range.low, range.high);
  // Only points and vertical segments can lie on the window's far side, which is outside.
  if (span.first >= window.x1) return;
  CellPiece pieces[3];
  const CellPiece* rest = &row;
  for (int x = span.first; x < span.last; ++x) {
    CellPiece* next = &pieces[(x - span.first) % 2];
    split_piece(*rest, 0, x + 1, &pieces[2], next);
    add_if_massive(x, y, pieces[2], sink);
    rest = next;
  }
  add_if_massive(span.last, y, *rest, sink);
}

void sweep_row(const CellPiece& row, int y, const CellWindow& window, CellSink* sink) {
  const Range range = extent(row, 0);
  const bool may_fill = !row.is_barycentric && range.high - range.low >= 1.0;
  const CellSpan full = may_fill ? full_cells(row, y) : CellSpan{0, -1};
  if (full.last < full.first) {
    sweep_columns(row, y, range, window, sink);
    return;
  }
  CellPiece side;
  CellPiece rest;
  const double full_low = full.first;
  const double full_high = full.last + 1;
  if (range.low < full_low) {
    split_piece(row, 0, full_low, &side, &rest);
    sweep_columns(side, y, {range.low, full_low}, window, sink);
  }
  sink->add_full(y, full.first, full.last + 1, row.mass_per_area);
  if (range.high > full_high) {
    split_piece(row, 0, full_high, &rest, &side);
    sweep_columns(side, y, {full_high, range.high}, window, sink);
  }
}

}  // namespace

double CellPiece::mass() const {
  const std::array<GridPoint, kMaxCorners>& points = is_barycentric ? sources : corners;
  double doubled = 0.0;
  for (int i = 2; i < count; ++i) doubled += twice_area(points[0], points[i - 1], points[i]);
  return 0.5 * doubled * mass_per_area;
}

void CellPiece::add_moments(double cell_x, double cell_y, WeightMoments* moments) const {
  const std::array<GridPoint, kMaxCorners>& points = is_barycentric ? sources : corners;
  const XyPair cell = {cell_x, cell_y};
  const auto point = [&](int i) { return XyPair{corners[i].x, corners[i].y} - cell; };
  // Triangles (0, i - 1, i) of the fan. Their common corner 0 is multiplied in at the end.
  PointSeries total{};
  for (int i = 2; i < count; ++i) {
    const double mass = 0.5 * mass_per_area * twice_area(points[0], points[i - 1], points[i]);
    add(mass, with_point(series_of(point(i - 1)), point(i)), &total);
  }
  add_means(with_point(total, point(0)), moments);
}

CellSpan cell_span(double low, double high) {
  const int first = static_cast<int>(std::floor(low));
  if (!(high > low)) return {first, first};
  return {first, std::max(first, static_cast<int>(std::ceil(high)) - 1)};
}

void split_piece(const CellPiece& piece, int axis, double value, CellPiece* low, CellPiece* high) {
  low->count = 0;
  high->count = 0;
  low->mass_per_area = high->mass_per_area = piece.mass_per_area;
  low->is_barycentric = high->is_barycentric = piece.is_barycentric;
  if (piece.count == 0) return;
  int previous = piece.count - 1;
  double previous_value = coordinate(piece.corners[previous], axis);
  for (int i = 0; i < piece.count; ++i) {
    const double current_value = coordinate(piece.corners[i], axis);
    if ((previous_value < value && current_value > value) ||
        (previous_value > value && current_value < value)) {
      add_crossing(piece, previous, i, axis, value, low, high);
    }
    if (current_value <= value) add_corner(piece, i, low);
    if (current_value >= value) add_corner(piece, i, high);
    previous = i;
    previous_value = current_value;
    assert(low->count <= CellPiece::kMaxCorners && high->count <= CellPiece::kMaxCorners);
  }
}

CellPiece whole_piece(const MassTriangle& triangle, bool is_barycentric) {
  const std::array<GridPoint, 3>& p = triangle.corners;
  CellPiece piece;
  piece.count = 3;
  std::copy(p.begin(), p.end(), piece.corners.begin());

  // Rounding errors of areas are about 1e-16 of length times magnitude of the coordinates. Where
  // they could exceed 1e-7 of the area, areas are computed in barycentric coordinates.
  constexpr double kMaxFlatness = 1e-9;
  double length = 0.0;
  double magnitude = 0.0;
  for (int i = 0; i < 3; ++i) {
    const GridPoint& a = p[i];
    const GridPoint& b = p[(i + 1) % 3];
    length = std::max({length, std::abs(b.x - a.x), std::abs(b.y - a.y)});
    magnitude = std::max({magnitude, std::abs(a.x), std::abs(a.y)});
  }
  const double doubled = twice_area(p[0], p[1], p[2]);
  piece.is_barycentric = is_barycentric || doubled <= kMaxFlatness * length * magnitude;
  if (piece.is_barycentric) {
    piece.sources[0] = {0.0, 0.0};
    piece.sources[1] = {1.0, 0.0};
    piece.sources[2] = {0.0, 1.0};
  }
  piece.mass_per_area = 2.0 * triangle.mass / (piece.is_barycentric ? 1.0 : doubled);
  return piece;
}

void cut_to_cells(const MassTriangle& triangle, const CellWindow& window, CellSink* sink) {
  if (!(triangle.mass > 0.0)) return;
  CellPiece whole = whole_piece(triangle);
  keep_between(&whole, 1, window.y0, window.y1);
  keep_between(&whole, 0, window.x0, window.x1);
  if (whole.count < 3) return;

  const Range range = extent(whole, 1);
  const CellSpan span = cell_span(range.low, range.high);
  if (span.first >= window.y1) return;
  CellPiece pieces[3];
  const CellPiece* rest = &whole;
  for (int y = span.first; y < span.last; ++y) {
    CellPiece* next = &pieces[(y - span.first) % 2];
    split_piece(*rest, 1, y + 1, &pieces[2], next);
    sweep_row(pieces[2], y, window, sink);
    rest = next;
  }
  sweep_row(*rest, span.last, window, sink);
}

}  // namespace prefilter
