// SPDX-License-Identifier: GPL-3.0-or-later

// Approximates curves adaptively by parabolas through three points.
#include "prefilter/shapes/raster/parabolas.h"

#include <utility>

namespace prefilter {
namespace {

constexpr int kMaxParabolaHalvings = 12;
// Smaller than kParabolaError, as the error between the tested points may be larger.
constexpr double kTestedParabolaError = 0.1 * kParabolaError;

Parabola rising(Parabola chord) {
  if (chord.low.y > chord.high.y) {
    std::swap(chord.low, chord.high);
    std::swap(chord.t_low, chord.t_high);
  }
  return chord;
}

// The parabola through both ends and the curve's point at the middle parameter.
Parabola parabola_through(const Point2& begin, const Point2& middle, const Point2& end,
                          double t_begin, double t_end) {
  Parabola out = rising({begin, end, 0.0, t_begin, t_end, 0.0});
  const double up = middle.y - out.low.y;
  const double down = middle.y - out.high.y;
  // A middle point too close to the height of an end does not determine the bend.
  const double height = out.high.y - out.low.y;
  if (!(up > 0.05 * height && -down > 0.05 * height)) return out;
  const Point2 way = out.high - out.low;
  const double share = up / height;
  out.bend = (middle.x - out.low.x - share * way.x) / (up * down);
  out.t_bend =
      (0.5 - (out.t_low < out.t_high ? share : 1.0 - share)) * (t_end - t_begin) / (up * down);
  return out;
}

class ParabolaFitter {
 public:
  ParabolaFitter(const MonotoneCurve& piece, const IsSeen& is_seen, std::vector<Parabola>* out)
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
    // A parabola with a bend passes through the middle by construction.
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
  // Whether the area between parabola and point is small; a cell contains at most a cell's height
  // of it.
  static bool is_near(const Parabola& parabola, const Point2& point) {
    const double height = parabola.high.y - parabola.low.y;
    return std::abs(parabola.x_at(point.y) - point.x) * std::min(height, 1.0) <=
           kTestedParabolaError;
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
  ParabolaFitter(piece, is_seen, parabolas)
      .append(piece.begin, piece.t_begin, piece.end, piece.t_end, kMaxParabolaHalvings);
}

}  // namespace prefilter
