// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/shapes/raster/parabolas.h"

#include <utility>

namespace prefilter {
namespace {

constexpr int kMostHalves = 12;
// Between the places that are looked at a parabola may be off by more.
constexpr double kErrorThere = 0.1 * kParabolaError;

Parabola rising(Parabola chord) {
  if (chord.low.y > chord.high.y) {
    std::swap(chord.low, chord.high);
    std::swap(chord.t_low, chord.t_high);
  }
  return chord;
}

// Between two parameters, through the point at the middle one.
Parabola parabola_through(const Point2& begin, const Point2& middle, const Point2& end,
                          double t_begin, double t_end) {
  Parabola out = rising({begin, end, 0.0, t_begin, t_end, 0.0});
  const double up = middle.y - out.low.y;
  const double down = middle.y - out.high.y;
  // A middle at a height of the ends does not tell.
  const double height = out.high.y - out.low.y;
  if (!(up > 0.05 * height && -down > 0.05 * height)) return out;
  const Point2 way = out.high - out.low;
  const double share = up / height;
  out.bend = (middle.x - out.low.x - share * way.x) / (up * down);
  out.t_bend =
      (0.5 - (out.t_low < out.t_high ? share : 1.0 - share)) * (t_end - t_begin) / (up * down);
  return out;
}

class ParabolaMaker {
 public:
  ParabolaMaker(const MonotoneCurve& piece, const IsSeen& is_seen, std::vector<Parabola>* out)
      : piece_(piece), is_seen_(is_seen), out_(out) {}

  void append(const Point2& begin, double t_begin, const Point2& end, double t_end, int halves) {
    if (begin.y == end.y) return;
    if (!is_seen_(begin, end)) {
      out_->push_back(rising({begin, end, 0.0, t_begin, t_end, 0.0}));
      return;
    }
    const double middle = 0.5 * (t_begin + t_end);
    const Point2 point = within(piece_.curve.at(middle), begin, end);
    const Parabola parabola = parabola_through(begin, point, end, t_begin, t_end);
    // With a bend it passes the middle.
    if (halves == 0 || ((parabola.bend != 0.0 || is_near(parabola, point)) &&
                        is_near(parabola, 0.5 * (t_begin + middle), begin, end) &&
                        is_near(parabola, 0.5 * (middle + t_end), begin, end))) {
      out_->push_back(parabola);
      return;
    }
    append(begin, t_begin, point, middle, halves - 1);
    append(point, middle, end, t_end, halves - 1);
  }

 private:
  static Point2 within(const Point2& point, const Point2& a, const Point2& b) {
    return {std::clamp(point.x, std::min(a.x, b.x), std::max(a.x, b.x)),
            std::clamp(point.y, std::min(a.y, b.y), std::max(a.y, b.y))};
  }
  bool is_near(const Parabola& parabola, double t, const Point2& begin, const Point2& end) const {
    return is_near(parabola, within(piece_.curve.at(t), begin, end));
  }
  // Whether what lies between is little, of which a cell holds no more than a cell's height.
  static bool is_near(const Parabola& parabola, const Point2& point) {
    const double height = parabola.high.y - parabola.low.y;
    return std::abs(parabola.x_at(point.y) - point.x) * std::min(height, 1.0) <= kErrorThere;
  }

  const MonotoneCurve& piece_;
  const IsSeen& is_seen_;
  std::vector<Parabola>* out_;
};

}  // namespace

void append_parabolas(const MonotoneCurve& piece, const IsSeen& is_seen,
                      std::vector<Parabola>* parabolas) {
  if (piece.begin.y == piece.end.y) return;
  if (piece.curve.kind == CurveKind::kLine) {
    parabolas->push_back(rising({piece.begin, piece.end, 0.0, 0.0, 1.0, 0.0}));
    return;
  }
  ParabolaMaker(piece, is_seen, parabolas)
      .append(piece.begin, piece.t_begin, piece.end, piece.t_end, kMostHalves);
}

}  // namespace prefilter
