// Cutting follows section 7.2 (triangles cut so that their images meet only one cell); the moments
// of a piece come from the 6-point rule of degree 4 over its fan, which is exact for x^2 y^2
// (Strang and Fix, "An Analysis of the Finite Element Method", 1973, p. 184).
#include "prefilter/moments/triangle_cells.h"

#include <algorithm>
#include <cassert>

namespace prefilter {
namespace {

struct QuadraturePoint {
  double b0, b1, b2;  // barycentric
  double weight;      // they sum to 1
};

std::array<QuadraturePoint, 6> make_rule() {
  const double root10 = std::sqrt(10.0);
  const double inner = std::sqrt(38.0 - 44.0 * std::sqrt(0.4));
  const double a[2] = {(8.0 - root10 + inner) / 18.0, (8.0 - root10 - inner) / 18.0};
  const double root = std::sqrt(213125.0 - 53320.0 * root10);
  const double w[2] = {(620.0 + root) / 3720.0, (620.0 - root) / 3720.0};
  std::array<QuadraturePoint, 6> rule{};
  for (int k = 0; k < 2; ++k) {
    const double b = 1.0 - 2.0 * a[k];
    rule[3 * k] = {b, a[k], a[k], w[k]};
    rule[3 * k + 1] = {a[k], b, a[k], w[k]};
    rule[3 * k + 2] = {a[k], a[k], b, w[k]};
  }
  return rule;
}

const std::array<QuadraturePoint, 6> kRule = make_rule();

double coordinate(const PieceCorner& corner, int axis) { return axis == 0 ? corner.x : corner.y; }

double twice_area(const PieceCorner& a, const PieceCorner& b, const PieceCorner& c) {
  return std::abs((b.s - a.s) * (c.t - a.t) - (c.s - a.s) * (b.t - a.t));
}

// The point of the edge where the coordinate along `axis` is `value`, and exactly that. The
// parameter is taken from the same end whichever way the edge runs, so two triangles that share it
// agree.
PieceCorner cross(PieceCorner p, PieceCorner q, int axis, double value) {
  if (coordinate(p, axis) > coordinate(q, axis)) std::swap(p, q);
  const double span = coordinate(q, axis) - coordinate(p, axis);
  const double f = (value - coordinate(p, axis)) / span;
  PieceCorner r{p.x + f * (q.x - p.x), p.y + f * (q.y - p.y), p.s + f * (q.s - p.s),
                p.t + f * (q.t - p.t)};
  (axis == 0 ? r.x : r.y) = value;
  return r;
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

// Cuts away what lies outside of [low, high] along an axis.
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

// Cells of a row that lie inside of a piece which was cut to that row. The piece is convex, so it
// holds the rectangle between the larger of its left ends and the smaller of its right ends on the
// row's two sides.
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

// Sends a piece of row y to the sink, column by column.
void sweep_columns(const CellPiece& row, int y, const CellWindow& window, CellSink* sink) {
  const Range range = extent(row, 0);
  const CellSpan span = cell_span(range.low, range.high);
  // Only a point or an upright segment can lie on the window's far side, which is not the window's.
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
  const CellSpan full = row.flat ? CellSpan{0, -1} : full_cells(row, y);
  if (full.last < full.first) {
    sweep_columns(row, y, window, sink);
    return;
  }
  const Range range = extent(row, 0);
  CellPiece side;
  CellPiece rest;
  if (range.low < full.first) {
    split_piece(row, 0, full.first, &side, &rest);
    sweep_columns(side, y, window, sink);
  }
  sink->add_full(y, full.first, full.last + 1, row.mass_per_area);
  if (range.high > full.last + 1) {
    split_piece(row, 0, full.last + 1, &rest, &side);
    sweep_columns(side, y, window, sink);
  }
}

}  // namespace

double CellPiece::mass() const {
  double doubled = 0.0;
  for (int i = 2; i < count; ++i) doubled += twice_area(corners[0], corners[i - 1], corners[i]);
  return 0.5 * doubled * mass_per_area;
}

void CellPiece::add_moments(double cell_x, double cell_y, WeightMoments* moments) const {
  WeightMoments sum{};
  for (int i = 2; i < count; ++i) {
    const PieceCorner& a = corners[0];
    const PieceCorner& b = corners[i - 1];
    const PieceCorner& c = corners[i];
    const double mass = 0.5 * mass_per_area * twice_area(a, b, c);
    if (mass == 0.0) continue;
    for (const QuadraturePoint& q : kRule) {
      const double x = q.b0 * a.x + q.b1 * b.x + q.b2 * c.x - cell_x;
      const double y = q.b0 * a.y + q.b1 * b.y + q.b2 * c.y - cell_y;
      const double w = q.weight * mass;
      const double wx = w * x;
      const double wxx = wx * x;
      const double yy = y * y;
      sum[0] += w;
      sum[1] += wx;
      sum[2] += wxx;
      sum[3] += w * y;
      sum[4] += wx * y;
      sum[5] += wxx * y;
      sum[6] += w * yy;
      sum[7] += wx * yy;
      sum[8] += wxx * yy;
    }
  }
  for (int i = 0; i < 9; ++i) (*moments)[i] += sum[i];
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
  low->flat = high->flat = piece.flat;
  if (piece.count == 0) return;
  const PieceCorner* previous = &piece.corners[piece.count - 1];
  double previous_value = coordinate(*previous, axis);
  for (int i = 0; i < piece.count; ++i) {
    const PieceCorner* current = &piece.corners[i];
    const double current_value = coordinate(*current, axis);
    if ((previous_value < value && current_value > value) ||
        (previous_value > value && current_value < value)) {
      const PieceCorner at = cross(*previous, *current, axis, value);
      low->corners[low->count++] = at;
      high->corners[high->count++] = at;
    }
    if (current_value <= value) low->corners[low->count++] = *current;
    if (current_value >= value) high->corners[high->count++] = *current;
    previous = current;
    previous_value = current_value;
    assert(low->count <= CellPiece::kMaxCorners && high->count <= CellPiece::kMaxCorners);
  }
}

CellPiece whole_piece(const MassTriangle& triangle) {
  const std::array<Point2, 3>& p = triangle.corners;
  CellPiece piece;
  piece.count = 3;
  for (int i = 0; i < 3; ++i) piece.corners[i] = {p[i].x, p[i].y, p[i].x, p[i].y};

  // Rounding of the coordinates makes areas wrong by about 1e-16 of length times magnitude. Where
  // that could be more than 1e-7 of the area, areas are taken in barycentric space.
  constexpr double kFlat = 1e-9;
  double length = 0.0;
  double magnitude = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Point2& a = p[i];
    const Point2& b = p[(i + 1) % 3];
    length = std::max({length, std::abs(b.x - a.x), std::abs(b.y - a.y)});
    magnitude = std::max({magnitude, std::abs(a.x), std::abs(a.y)});
  }
  const double doubled = twice_area(piece.corners[0], piece.corners[1], piece.corners[2]);
  piece.flat = doubled <= kFlat * length * magnitude;
  if (piece.flat) {
    constexpr double kBarycentric[3][2] = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
    for (int i = 0; i < 3; ++i) {
      piece.corners[i].s = kBarycentric[i][0];
      piece.corners[i].t = kBarycentric[i][1];
    }
  }
  piece.mass_per_area = 2.0 * triangle.mass / (piece.flat ? 1.0 : doubled);
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
