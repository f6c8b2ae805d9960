// Section 2.2 for curves and the box filter.
//
// As in box_lines.cpp, a row's pixels follow from E_k, the integral over y of how far x is beyond a
// line between columns; the integral of x dy along a piece of a curve is a polynomial of its
// parameter. An error of a root changes an E_k, and an integral that goes on to the line between
// rows at a constant x, by its square only: 1e-5 pixels by less than 1e-9 where the curve rises
// at less than 10 to 1.

#include "prefilter/raster/box_curves.h"

#include <algorithm>
#include <cmath>

#include "prefilter/moments/arc_moments.h"
#include "prefilter/raster/box_lines.h"

namespace prefilter {
namespace {

constexpr double kMostMiss = 1e-6;  // of a root, in pixels

DoublePair value_of(const std::array<double, 4>& p, DoublePair s) {
  return p[0] + s * (p[1] + s * (p[2] + s * p[3]));
}

// Roots of a polynomial that rises or falls over [0, 1].
class Roots {
 public:
  Roots(const std::array<double, 4>& p, bool is_cubic)
      : p_(p), is_cubic_(is_cubic), begin_(p[0]), rise_(p[1] + p[2] + p[3]), scale_(1.0 / rise_) {
    // Slopes at both ends, where the polynomial rises by 1; a monotone cubic has none above 4.
    first_slope_ = std::clamp(p[1] * scale_, 0.0, 4.0);
    const double last_slope = std::clamp((p[1] + 2.0 * p[2] + 3.0 * p[3]) * scale_, 0.0, 4.0);
    bend_ = is_cubic ? first_slope_ + last_slope - 2.0 : 0.0;
  }

  DoublePair operator()(DoublePair values) const {
    // The rational function with the same ends and slopes there; a quadratic is one.
    const DoublePair zero{};
    const DoublePair one = pair_of(1.0);
    const DoublePair v = higher(lower((values - begin_) * scale_, one), zero);
    const DoublePair b = first_slope_ - bend_ * v;
    const DoublePair root = sqrt(higher(b * b + 4.0 * (1.0 - b) * v, zero));
    DoublePair s = 2.0 * v / higher(b + root, pair_of(1e-300));
    if (!is_cubic_) return lower(s, one);
    // Of a value beyond the ends, next to the last line, the root is of no use.
    values = begin_ + v * rise_;
    for (int step = 0; step < 2; ++step) s = halley(values, s);
    s = higher(lower(s, one), zero);
    const DoublePair miss = value_of(p_, s) - values;
    for (int lane = 0; lane < 2; ++lane) {
      if (!(std::abs(miss[lane]) <= kMostMiss)) s[lane] = by_halves(values[lane]);
    }
    return s;
  }

 private:
  DoublePair halley(DoublePair values, DoublePair s) const {
    const DoublePair off = value_of(p_, s) - values;
    const DoublePair slope = p_[1] + s * (2.0 * p_[2] + s * (3.0 * p_[3]));
    const DoublePair half_bend = p_[2] + s * (3.0 * p_[3]);
    return s - off * slope / (slope * slope - off * half_bend);
  }
  // For the few cubics that are level somewhere.
  double by_halves(double value) const {
    double low = 0.0;
    double high = 1.0;
    for (int step = 0; step < 52; ++step) {
      const double middle = 0.5 * (low + high);
      const double at = value_of(p_, pair_of(middle))[0];
      ((at - value) * scale_ > 0.0 ? high : low) = middle;
    }
    return 0.5 * (low + high);
  }

  const std::array<double, 4>& p_;
  bool is_cubic_;
  double begin_;
  double rise_;
  double scale_;
  double first_slope_;
  double bend_;
};

}  // namespace

BoxCurves::Piece BoxCurves::polynomials(const MonotoneCurve& piece) {
  const auto& powers = piece.curve.powers;
  const double t = piece.t_begin;
  const double w = piece.t_end - piece.t_begin;
  Piece out;
  out.is_cubic = piece.curve.kind == CurveKind::kCubic;
  out.column = std::floor(piece.begin.x);
  // p(t + w s), but for the ends, which are as they are.
  const Point2 p1 = w * (powers[1] + t * (2.0 * powers[2] + (3.0 * t) * powers[3]));
  const Point2 p2 = (w * w) * (powers[2] + (3.0 * t) * powers[3]);
  const Point2 p3 = (w * w * w) * powers[3];
  out.x = {piece.begin.x - out.column, p1.x, p2.x, p3.x};
  out.y = {piece.begin.y, p1.y, p2.y, p3.y};
  const auto& x = out.x;
  const auto& y = out.y;
  out.area = {x[0] * y[1],
              (x[1] * y[1] + 2.0 * x[0] * y[2]) / 2.0,
              (x[2] * y[1] + 2.0 * x[1] * y[2] + 3.0 * x[0] * y[3]) / 3.0,
              (x[3] * y[1] + 2.0 * x[2] * y[2] + 3.0 * x[1] * y[3]) / 4.0,
              (2.0 * x[3] * y[2] + 3.0 * x[2] * y[3]) / 5.0,
              3.0 * x[3] * y[3] / 6.0};
  return out;
}

namespace {

DoublePair area_at(const std::array<double, 6>& g, DoublePair s) {
  return s * (g[0] + s * (g[1] + s * (g[2] + s * (g[3] + s * (g[4] + s * g[5])))));
}

}  // namespace

// The ends are at the back and the lines in front, two at a time.
void BoxCurves::find_rows(const Piece& piece, double low, double high, bool rises) {
  const auto first = static_cast<int>(std::max(std::floor(low) + 1.0, rows_.first_row() + 0.0));
  const auto last = static_cast<int>(std::min(std::ceil(high) - 1.0, rows_.end_row() + 0.0));
  const bool has_low = low >= rows_.first_row();
  const bool has_high = high <= rows_.end_row();
  const int lines = std::max(0, last - first + 1);
  const int count = lines + (has_low ? 1 : 0) + (has_high ? 1 : 0);
  at_rows_.resize(count + 1);
  const Roots roots(piece.y, piece.is_cubic);
  const double x_end = piece.x[0] + piece.x[1] + piece.x[2] + piece.x[3];
  const double left = std::min(piece.x[0], x_end);
  const double right = std::max(piece.x[0], x_end);
  const auto put = [&](int place, DoublePair y, DoublePair s) {
    const DoublePair x = lower(higher(value_of(piece.x, s), pair_of(left)), pair_of(right));
    const DoublePair area = area_at(piece.area, s) + x * (y - value_of(piece.y, s));
    std::memcpy(&at_rows_.x[place], &x, sizeof(x));
    std::memcpy(&at_rows_.y[place], &y, sizeof(y));
    std::memcpy(&at_rows_.area[place], &area, sizeof(area));
  };
  int place = 0;
  if (has_low) put(place++, pair_of(low), pair_of(rises ? 0.0 : 1.0));
  for (int line = 0; line < lines; line += 2) {
    const DoublePair y = DoublePair{first + line + 0.0, first + line + 1.0};
    put(place + line, y, roots(y));
  }
  if (has_high) put(place + lines, pair_of(high), pair_of(rises ? 1.0 : 0.0));
  at_rows_.resize(count);
}

void BoxCurves::find_columns(const Piece& piece, int first, int end) {
  at_columns_.resize(std::max(0, end - first) + 1);
  const Roots roots(piece.x, piece.is_cubic);
  for (int column = first; column < end; column += 2) {
    const DoublePair x = DoublePair{column - piece.column, column - piece.column + 1.0};
    const DoublePair s = roots(x);
    const DoublePair y = value_of(piece.y, s);
    const DoublePair area = area_at(piece.area, s);
    const int place = column - first;
    std::memcpy(&at_columns_.y[place], &y, sizeof(y));
    std::memcpy(&at_columns_.area[place], &area, sizeof(area));
  }
}

void BoxCurves::add(const MonotoneCurve& piece, int sign) {
  const auto is_far = [](const Point2& p) {
    return std::abs(p.x) > kFarthestBoxPixel || std::abs(p.y) > kFarthestBoxPixel;
  };
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

  const Piece polynomial = polynomials(piece);
  find_rows(polynomial, low, high, rises);
  const std::size_t places = at_rows_.x.size();
  const auto column_of = [&](double x) { return polynomial.column + x; };
  const double x_first = column_of(at_rows_.x.front());
  const double x_last = column_of(at_rows_.x.back());
  const bool x_rises = x_last >= x_first;
  // Lines between columns that matter in the image.
  const auto clamp_line = [&](double x) {
    return static_cast<int>(std::clamp(std::floor(x), -1.0, rows_.width() + 0.0));
  };
  const int first_line = clamp_line(std::min(x_first, x_last)) + 1;
  const int end_line = clamp_line(std::max(x_first, x_last)) + 1;
  find_columns(polynomial, first_line, end_line);

  const double scale = static_cast<double>(1 << kBoxBits) * (rises ? sign : -sign);
  for (std::size_t i = 0; i + 1 < places; ++i) {
    const double y = at_rows_.y[i];
    const double top = at_rows_.y[i + 1];
    const auto row = static_cast<int>(std::floor(y));
    const double left = column_of(std::min(at_rows_.x[i], at_rows_.x[i + 1]));
    const double right = column_of(std::max(at_rows_.x[i], at_rows_.x[i + 1]));
    const double column = std::floor(left);
    const std::uint32_t height = to_steps((top - y) * scale);
    const std::uint32_t inside = to_steps(
        (at_rows_.area[i + 1] - at_rows_.area[i] - (column - polynomial.column) * (top - y)) *
        scale);
    const auto clamped =
        static_cast<int>(std::clamp(column, -1.0 * DifferenceRows::kMargin, rows_.width() + 0.0));
    const DifferenceRows::Row to = rows_.row(row);
    to.add_two(clamped, height - inside, inside);
    const int end = std::min(clamp_line(right) + 1, end_line);
    for (int line = std::max(clamp_line(left) + 1, first_line); line < end; ++line) {
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

// All other curves, cell by cell.
void BoxCurves::add_cells(const MonotoneCurve& piece, int sign) {
  const GridWindow window{0, rows_.width(), rows_.first_row(), rows_.end_row()};
  const auto in_cell = [&](int column, int row, const CellArc& arc) {
    const Point2 center{column + 0.5, row + 0.5};
    cell_.assign(1, {});
    if (piece.curve.kind == CurveKind::kLine) {
      batch_.add_line(arc.begin - center, arc.end - center, sign, 0, &cell_);
    } else {
      batch_.add_curve(piece.curve, arc, center, sign, 0, &cell_);
    }
    batch_.flush(&cell_);
    const double steps = (rounded_to_unit(arc.end.y) - rounded_to_unit(arc.begin.y)) / kBoxUnit;
    const std::int32_t height = sign * static_cast<std::int32_t>(steps);
    const auto part = static_cast<std::uint32_t>(cell_[0].inside(0, 0) + height / 2);
    rows_.row(row).add_two(column, static_cast<std::uint32_t>(height) - part, part);
  };
  const auto left_of_window = [&](int row, double y_begin, double y_end) {
    rows_.row(row).add(
        -1, to_steps(sign * (rounded_to_unit(y_end) - rounded_to_unit(y_begin)) * (1 << kBoxBits)));
  };
  cut_to_cells(piece, window, in_cell, left_of_window);
}

}  // namespace prefilter
