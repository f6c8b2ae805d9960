// SPDX-License-Identifier: GPL-3.0-or-later

// Section 3.2.2; every curve is cut only once, along the finest cells.
#include "prefilter/wavelet/outline_strip.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "prefilter/geometry/moments/cell_cutter.h"

namespace prefilter {
namespace {

constexpr int kBrickCells = kPlaneBrickSide * kPlaneBrickSide;

// Inserts a zero after each bit of a number below 8.
constexpr std::array<std::uint8_t, kPlaneBrickSide> kSpreadBits = {0, 1, 4, 5, 16, 17, 20, 21};

// Rounds to the nearest multiple of 2^-26; magnitudes must be below 2^25.
double rounded(double value) {
  constexpr double kMagic = 1.5 * (1 << 26);
  return (value + kMagic) - kMagic;
}

Point2 rounded(const Point2& point) { return {rounded(point.x), rounded(point.y)}; }

// The cell that a curve enters at a coordinate, in its direction.
int first_cell(double value, bool rises) {
  return static_cast<int>(rises ? std::floor(value) : std::ceil(value) - 1.0);
}

double three_point_integral(const ParametricCurve& curve, double t_begin, double t_end,
                            double column) {
  constexpr double kOutermost = 0.77459666924148337704;  // sqrt(3 / 5)
  const double half = 0.5 * (t_end - t_begin);
  const double middle = t_begin + half;
  const auto at = [&](double t) { return (curve.at(t).x - column) * curve.derivative(t).y; };
  return half * (8.0 / 9.0 * at(middle) +
                 5.0 / 9.0 * (at(middle - kOutermost * half) + at(middle + kOutermost * half)));
}

// Bisects adaptively, until the halves agree with the whole.
double halved_integral(const ParametricCurve& curve, double t_begin, double t_end, double column,
                       double whole, int halvings) {
  constexpr double kMaxHalvingDifference = 1e-9;
  const double middle = 0.5 * (t_begin + t_end);
  const double low = three_point_integral(curve, t_begin, middle, column);
  const double high = three_point_integral(curve, middle, t_end, column);
  if (halvings == 0 || std::abs(low + high - whole) < kMaxHalvingDifference) return low + high;
  return halved_integral(curve, t_begin, middle, column, low, halvings - 1) +
         halved_integral(curve, middle, t_end, column, high, halvings - 1);
}

// The integral of (x - column) dy.
double integral_along(const ParametricCurve& curve, double t_begin, double t_end, double column) {
  constexpr int kMaxHalvings = 12;
  const double whole = three_point_integral(curve, t_begin, t_end, column);
  return halved_integral(curve, t_begin, t_end, column, whole, kMaxHalvings);
}

template <bool kIsCubic>
DoublePair value_of(const CubicPowers& p, DoublePair s) {
  if constexpr (kIsCubic) return p[0] + s * (p[1] + s * (p[2] + s * p[3]));
  return p[0] + s * (p[1] + s * p[2]);
}

template <bool kIsCubic>
DoublePair value_of(const std::array<double, 6>& area, DoublePair s) {
  DoublePair sum = pair_of(area[3]);
  if constexpr (kIsCubic) sum += s * (area[4] + s * area[5]);
  return s * (area[0] + s * (area[1] + s * (area[2] + s * sum)));
}

// Whether polynomials over pieces of a curve are exact enough: distant control points would cause
// cancellation.
bool has_near_polynomials(const ParametricCurve& curve) {
  constexpr double kMaxNearCoefficient = 1 << 20;
  if (curve.kind != CurveKind::kQuadratic && curve.kind != CurveKind::kCubic) return false;
  return std::all_of(curve.powers.begin(), curve.powers.end(), [](const Point2& power) {
    return std::abs(power.x) < kMaxNearCoefficient && std::abs(power.y) < kMaxNearCoefficient;
  });
}

double between(double value, double a, double b) {
  return std::clamp(value, std::min(a, b), std::max(a, b));
}

// Adds the flux of an arc between points in cell coordinates, given its integral of x dy.
void add_arc(const Point2& a, const Point2& b, double integral, double sign, PlaneFlux* flux) {
  const auto [moment_x, b_product] = rounded(Point2{integral, b.x * b.y});
  // The integral of y dx is the change of x y minus that of x dy.
  const double moment_y = moment_x - (b_product - rounded(a.x * a.y));
  flux->area_x += sign * (b.y - a.y);
  flux->area_y += sign * (a.x - b.x);
  flux->moment_x += sign * moment_x;
  flux->moment_y += sign * moment_y;
}

// Bit i of `touched` marks the i-th finer flux.
template <std::size_t N>
void nest(const PlaneFlux* finer, std::uint64_t touched, std::array<PlaneFlux, N>* fluxes,
          QuadrantSteps<float>* steps) {
  for (std::size_t i = 0; i < N; ++i, touched >>= 4) {
    if ((touched & 15U) == 0U) continue;
    const QuadrantFluxes quadrants = {finer[4 * i], finer[4 * i + 1], finer[4 * i + 2],
                                      finer[4 * i + 3]};
    (*fluxes)[i] = flux_of_quadrants(quadrants);
    steps[i] = steps_of_quadrants<float>(quadrants);
  }
}

}  // namespace

PlaneGrid::PlaneGrid(int width_, int height_) : width(width_), height(height_) {
  const auto side = static_cast<unsigned>(std::max(width, height));
  depth = std::max(kPlaneBrickDepth, static_cast<int>(std::bit_width(side - 1)));
}

void OutlineStrip::begin(const PlaneGrid& grid, int first_row, int end_row) {
  grid_ = grid;
  first_row_ = first_row;
  end_row_ = end_row;
  bricks_across_ = (grid.width + kPlaneBrickSide - 1) / kPlaneBrickSide;
  const int bricks_up = (end_row - first_row + kPlaneBrickSide - 1) / kPlaneBrickSide;
  slots_.assign(static_cast<std::size_t>(bricks_across_) * bricks_up, -1);
  pool_.clear();
  pool_.reserve(slots_.size());
  places_.clear();
  at_sides_ = {};
}

int OutlineStrip::new_brick(int x, int y) {
  pool_.emplace_back();
  places_.push_back({x, y});
  return static_cast<int>(places_.size()) - 1;
}

inline PlaneFlux& OutlineStrip::cell(int column, int row) {
  const int x = column >> kPlaneBrickDepth;
  const int y = row >> kPlaneBrickDepth;
  std::int32_t& slot =
      slots_[static_cast<std::size_t>(y - (first_row_ >> kPlaneBrickDepth)) * bricks_across_ + x];
  if (slot < 0) slot = new_brick(x, y);
  constexpr int kMask = kPlaneBrickSide - 1;
  return pool_[slot].cells[kSpreadBits[column & kMask] | (kSpreadBits[row & kMask] << 1)];
}

inline void OutlineStrip::add_chord(int column, int row, Point2 begin, Point2 end, double sign) {
  begin = begin - Point2{static_cast<double>(column), static_cast<double>(row)};
  end = end - Point2{static_cast<double>(column), static_cast<double>(row)};
  add_arc(begin, end, 0.5 * (begin.x + end.x) * (end.y - begin.y), sign, &cell(column, row));
}

StripBricks OutlineStrip::take() {
  StripBricks taken;
  taken.bricks.reserve(places_.size());
  taken.fluxes.reserve(places_.size());
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const auto& cells = pool_[i].cells;
    std::uint64_t touched = 0;
    for (int c = 0; c < kBrickCells; ++c) {
      touched |= static_cast<std::uint64_t>(!cells[c].is_zero()) << c;
    }
    const std::size_t slot =
        static_cast<std::size_t>(places_[i].y - (first_row_ >> kPlaneBrickDepth)) * bricks_across_ +
        places_[i].x;
    slots_[slot] = -1;
    if (touched == 0) continue;
    PlaneBrick& brick = taken.bricks.emplace_back();
    brick.x = places_[i].x;
    brick.y = places_[i].y;
    brick.touched = touched;
    std::array<PlaneFlux, 16> sixteenths;
    std::array<PlaneFlux, 4> quadrants;
    std::array<PlaneFlux, 1> whole;
    nest(cells.data(), touched, &sixteenths, brick.steps.data() + 5);
    nest(sixteenths.data(), ~std::uint64_t{0}, &quadrants, brick.steps.data() + 1);
    nest(quadrants.data(), ~std::uint64_t{0}, &whole, brick.steps.data());
    taken.fluxes.push_back(whole[0]);
  }
  taken.at_sides = at_sides_;
  pool_.clear();
  places_.clear();
  at_sides_ = {};
  return taken;
}

bool OutlineStrip::is_inside(const Point2& a, const Point2& b) const {
  const auto [x_low, x_high] = std::minmax(a.x, b.x);
  const auto [y_low, y_high] = std::minmax(a.y, b.y);
  return x_low >= 0.0 && x_high <= grid_.width && y_low >= first_row_ && y_high <= end_row_ &&
         (y_low < y_high || y_low > first_row_ || first_row_ == 0);
}

// Cuts a piece at the sides of the grid and of the strip. pass(axis, value) returns the parameter
// and the other coordinate of a crossing; inside(begin, t_begin, end, t_end) receives the parts
// inside.
template <typename Pass, typename Inside>
void OutlineStrip::clip(const MonotoneCurve& piece, double sign, const Pass& pass,
                        const Inside& inside) {
  struct Crossing {
    double t;
    Point2 point;
  };
  std::array<Crossing, 6> crossings;
  int count = 0;
  const auto add_crossing = [&](double t, const Point2& point) {
    int i = count++;
    for (; i > 0 && crossings[i - 1].t > t; --i) crossings[i] = crossings[i - 1];
    crossings[i] = {t, point};
  };
  add_crossing(piece.t_begin, piece.begin);
  const auto passes = [](double a, double b, double value) {
    return (a < value && value < b) || (b < value && value < a);
  };
  const double sides_x[] = {0.0, static_cast<double>(grid_.width)};
  const double sides_y[] = {static_cast<double>(first_row_), static_cast<double>(end_row_)};
  for (const double x : sides_x) {
    if (!passes(piece.begin.x, piece.end.x, x)) continue;
    const auto [t, y] = pass(0, x);
    add_crossing(t, {x, y});
  }
  for (const double y : sides_y) {
    if (!passes(piece.begin.y, piece.end.y, y)) continue;
    const auto [t, x] = pass(1, y);
    add_crossing(t, {x, y});
  }
  crossings[count++] = {piece.t_end, piece.end};
  for (int i = 0; i + 1 < count; ++i) {
    const Crossing& a = crossings[i];
    const Crossing& b = crossings[i + 1];
    if (is_inside(a.point, b.point)) {
      inside(a.point, a.t, b.point, b.t);
    } else {
      add_at_sides(a.point, b.point, sign);
    }
  }
}

// Adds a part outside the grid, moved to its sides. On the root's sides it affects no coefficient
// except the root's mean.
void OutlineStrip::add_at_sides(const Point2& a, const Point2& b, double sign) {
  const bool is_lowest = first_row_ == 0;
  const bool is_highest = end_row_ == grid_.height;
  const double y = 0.5 * (a.y + b.y);
  if (y <= first_row_ && !is_lowest) return;
  if (y > end_row_ && !is_highest) return;
  const double side = std::ldexp(1.0, grid_.depth);
  const auto moved = [&](const Point2& point) {
    return rounded(Point2{
        std::clamp(point.x, 0.0, static_cast<double>(grid_.width)),
        std::clamp(point.y, static_cast<double>(first_row_), static_cast<double>(end_row_))});
  };
  const Point2 begin = moved(a);
  const Point2 end = moved(b);
  if (begin == end) return;
  const PlaneFlux step{sign * (end.y - begin.y), sign * (begin.x - end.x), 0.0, 0.0};
  if (begin.x == end.x && begin.x == 0.0) {
    at_sides_.area_x += step.area_x;
  } else if (begin.x == end.x && begin.x == side) {
    at_sides_.area_x += step.area_x;
    at_sides_.moment_x += step.area_x * side;
  } else if (begin.y == end.y && begin.y == 0.0) {
    at_sides_.area_y += step.area_y;
  } else if (begin.y == end.y && begin.y == side) {
    at_sides_.area_y += step.area_y;
    at_sides_.moment_y += step.area_y * side;
  } else {
    add_inner_line(begin, end, sign);
  }
}

void OutlineStrip::add_line(const Point2& begin, const Point2& end, double sign) {
  if (is_inside(begin, end)) {
    add_inner_line(begin, end, sign);
    return;
  }
  MonotoneCurve piece;
  piece.begin = begin;
  piece.end = end;
  const Point2 along = end - begin;
  clip(
      piece, sign,
      [&](int axis, double value) {
        const double t = axis == 0 ? (value - begin.x) / along.x : (value - begin.y) / along.y;
        return std::pair(t, axis == 0 ? begin.y + (value - begin.x) * (along.y / along.x)
                                      : begin.x + (value - begin.y) * (along.x / along.y));
      },
      [&](const Point2& a, double, const Point2& b, double) { add_inner_line(a, b, sign); });
}

void OutlineStrip::add(const MonotoneCurve& piece, double sign) {
  const bool is_straight = piece.curve.kind == CurveKind::kLine || piece.begin.x == piece.end.x ||
                           piece.begin.y == piece.end.y;
  if (is_straight) {
    add_line(piece.begin, piece.end, sign);
  } else if (is_inside(piece.begin, piece.end)) {
    add_inner_curve(piece, sign);
  } else {
    clip(
        piece, sign,
        [&](int axis, double value) {
          const double t = crossing(piece, axis, value, piece.t_begin);
          const Point2 at = piece.curve.at(t);
          return std::pair(t, axis == 0 ? between(at.y, piece.begin.y, piece.end.y)
                                        : between(at.x, piece.begin.x, piece.end.x));
        },
        [&](const Point2& a, double t_begin, const Point2& b, double t_end) {
          MonotoneCurve part = piece;
          part.begin = a;
          part.t_begin = t_begin;
          part.end = b;
          part.t_end = t_end;
          add_inner_curve(part, sign);
        });
  }
}

void OutlineStrip::add_inner_line(const Point2& begin_, const Point2& end_, double sign) {
  const Point2 begin = rounded(begin_);
  const Point2 end = rounded(end_);
  const bool x_rises = end.x > begin.x;
  const bool y_rises = end.y > begin.y;
  // End points on a side of the grid belong to the cell inside.
  const auto column_of = [&](int column) { return std::clamp(column, 0, grid_.width - 1); };
  const auto row_of = [&](int row) { return std::clamp(row, first_row_, end_row_ - 1); };
  int column = column_of(first_cell(begin.x, x_rises));
  int row = row_of(first_cell(begin.y, y_rises));
  const int last_column = begin.x == end.x ? column : column_of(first_cell(end.x, !x_rises));
  const int last_row = begin.y == end.y ? row : row_of(first_cell(end.y, !y_rises));
  if (column == last_column && row == last_row) {
    add_chord(column, row, begin, end, sign);
    return;
  }
  const double y_per_x = (end.y - begin.y) / (end.x - begin.x);
  const double x_per_y = (end.x - begin.x) / (end.y - begin.y);
  const int x_step = x_rises ? 1 : -1;
  const int y_step = y_rises ? 1 : -1;
  Point2 at = begin;
  const auto y_at = [&](double x) { return rounded(begin.y + (x - begin.x) * y_per_x); };
  double next_x = x_rises ? column + 1 : column;
  double y_at_next_x = column != last_column ? y_at(next_x) : end.y;
  while (column != last_column || row != last_row) {
    const double next_y = y_rises ? row + 1 : row;
    Point2 next;
    const bool passes_x =
        row == last_row ||
        (column != last_column && (y_rises ? y_at_next_x <= next_y : y_at_next_x >= next_y));
    if (passes_x) {
      next = {next_x, between(y_at_next_x, at.y, end.y)};
    } else {
      const double x = rounded(begin.x + (next_y - begin.y) * x_per_y);
      next = {between(x, at.x, column != last_column ? next_x : end.x), next_y};
    }
    add_chord(column, row, at, next, sign);
    at = next;
    if (passes_x) {
      column += x_step;
      next_x += x_step;
      y_at_next_x = y_at(next_x);
    } else {
      row += y_step;
    }
  }
  add_chord(column, row, at, end, sign);
}

template <bool kIsCubic>
void OutlineStrip::Crossings::find(const MonotonePolynomials& piece, int axis, int first, int step,
                                   int count_) {
  count = count_;
  const auto room = static_cast<std::size_t>(count + 1);  // evaluated in pairs
  if (s.size() < room) {
    s.resize(room);
    other.resize(room);
    area.resize(room);
  }
  const MonotoneRoots<kIsCubic> roots(axis == 0 ? piece.x : piece.y);
  for (int i = 0; i < count; i += 2) {
    const double line = first + i * step - (axis == 0 ? piece.column : 0.0);
    const DoublePair lines{line, line + step};
    const auto [at, miss] = roots(lines);
    const DoublePair along = value_of<kIsCubic>(axis == 0 ? piece.y : piece.x, at);
    DoublePair up_to = value_of<kIsCubic>(piece.area, at);
    if (axis == 1) up_to -= along * miss;
    std::memcpy(&s[i], &at, sizeof(at));
    std::memcpy(&other[i], &along, sizeof(along));
    std::memcpy(&area[i], &up_to, sizeof(up_to));
  }
}

template <bool kIsCubic>
void OutlineStrip::add_inner_polynomials(const MonotoneCurve& piece, double sign) {
  const Point2& end = piece.end;
  const bool x_rises = end.x > piece.begin.x;
  const bool y_rises = end.y > piece.begin.y;
  const int x_step = x_rises ? 1 : -1;
  const int y_step = y_rises ? 1 : -1;
  int column = first_cell(piece.begin.x, x_rises);
  int row = first_cell(piece.begin.y, y_rises);
  const int column_count = std::abs(first_cell(end.x, !x_rises) - column);
  const int row_count = std::abs(first_cell(end.y, !y_rises) - row);
  const MonotonePolynomials polynomials(piece);
  columns_.find<kIsCubic>(polynomials, 0, column + (x_rises ? 1 : 0), x_step, column_count);
  rows_.find<kIsCubic>(polynomials, 1, row + (y_rises ? 1 : 0), y_step, row_count);

  Point2 at = piece.begin;
  double area = 0.0;
  const auto add_up_to = [&](const Point2& next, double next_area) {
    const Point2 corner{static_cast<double>(column), static_cast<double>(row)};
    const double integral = next_area - area - (corner.x - polynomials.column) * (next.y - at.y);
    add_arc(rounded(at - corner), rounded(next - corner), integral, sign, &cell(column, row));
    at = next;
    area = next_area;
  };
  for (int i = 0, j = 0; i < column_count || j < row_count;) {
    const double next_x = x_rises ? column + 1 : column;
    const double next_y = y_rises ? row + 1 : row;
    if (j == row_count || (i < column_count && columns_.s[i] <= rows_.s[j])) {
      const double y = between(columns_.other[i], at.y, j < row_count ? next_y : end.y);
      add_up_to({next_x, y},
                columns_.area[i] + (next_x - polynomials.column) * (y - columns_.other[i]));
      column += x_step;
      ++i;
    } else {
      add_up_to(
          {between(rows_.other[j] + polynomials.column, at.x, i < column_count ? next_x : end.x),
           next_y},
          rows_.area[j]);
      row += y_step;
      ++j;
    }
  }
  const DoublePair one = pair_of(1.0);
  const DoublePair short_of_end = end.y - value_of<kIsCubic>(polynomials.y, one);
  add_up_to(end, (value_of<kIsCubic>(polynomials.area, one) +
                  value_of<kIsCubic>(polynomials.x, one) * short_of_end)[0]);
}

void OutlineStrip::add_inner_curve(const MonotoneCurve& piece, double sign) {
  if (piece.begin.x == piece.end.x || piece.begin.y == piece.end.y) {
    add_inner_line(piece.begin, piece.end, sign);
    return;
  }
  if (has_near_polynomials(piece.curve)) {
    if (piece.curve.kind == CurveKind::kCubic) {
      add_inner_polynomials<true>(piece, sign);
    } else {
      add_inner_polynomials<false>(piece, sign);
    }
    return;
  }
  const auto in_cell = [&](int column, int row, const CellArc& arc) {
    const Point2 corner{static_cast<double>(column), static_cast<double>(row)};
    const double integral = integral_along(piece.curve, arc.t_begin, arc.t_end, corner.x);
    add_arc(rounded(arc.begin - corner), rounded(arc.end - corner), integral, sign,
            &cell(column, row));
  };
  cut_to_cells(piece, {0, grid_.width, first_row_, end_row_}, in_cell, [](int, double, double) {});
}

}  // namespace prefilter
