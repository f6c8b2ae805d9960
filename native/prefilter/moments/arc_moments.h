// The integrals along an arc in a cell that the moments of what lies right of it are made of.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "prefilter/base/lane_array.h"
#include "prefilter/moments/cell_cutter.h"

namespace prefilter {

/// Sums over the arcs in a cell, in fractions of 2^-kMomentBits. Whole numbers add up to the same
/// in any order; the arcs of an edge that two shapes share cancel; and what a closed contour leaves
/// behind its last arc is 0. They are added modulo 2^32: only what comes out needs to fit, which is
/// up to 32 windings.
inline constexpr int kMomentBits = 26;

/// Coordinates in a cell run from -1/2 to 1/2 around its center. Along y moments are those of
/// P_b(y) = y^b less its mean over the cell for even b above 0, so that P_0 alone tells a full row.
template <int N>
struct ArcMoments {
  static constexpr int kLanes = N < 4 ? 4 : N < 8 ? 8 : 16;
  using Floats = LaneArray<float, kLanes>;
  using Integers = LaneArray<std::uint32_t, kLanes>;

  /// The integral of x^(a + 1) / (a + 1) P_b(y) dy.
  std::int32_t inside(int a, int b) const { return static_cast<std::int32_t>(inside_[a][b]); }
  /// The integral of P_b(y) dy.
  std::int32_t across(int b) const { return static_cast<std::int32_t>(across_[b]); }

  void add_line(Point2 begin, Point2 end, int sign);
  void add_curve(const ParametricCurve& curve, const CellArc& arc, Point2 center, int sign);
  void add_across(double begin, double end, int sign);
  bool is_zero() const;

 private:
  static Floats lane_powers(float y);
  static Integers antiderivative(double y);
  void add_inside(const std::array<Floats, N + 1>& sums, int sign);

  std::array<Integers, N + 1> inside_{};
  Integers across_{};
};

/// The mean of y^b over [-1/2, 1/2]: its integral over a cell.
constexpr double mean_power(int b) {
  if (b % 2 != 0) return 0.0;
  double mean = 1.0 / (b + 1);
  for (int i = 0; i < b; ++i) mean *= 0.5;
  return mean;
}

/// x^(a + 1) / (a + 1) at a cell's high end.
constexpr double at_high_end(int a) {
  double power = 1.0;
  for (int i = 0; i <= a; ++i) power *= 0.5;
  return power / (a + 1);
}

namespace internal {

/// Gauss's rule of K points on [0, 1].
template <int K>
struct GaussRule {
  std::array<double, K> nodes;
  std::array<double, K> weights;
};

template <int K>
const GaussRule<K>& gauss_rule() {
  static const GaussRule<K> rule = [] {
    GaussRule<K> made{};
    for (int i = 0; i < K; ++i) {
      // Newton's steps to a root of Legendre's polynomial, from Chebyshev's.
      double x = std::cos(M_PI * (i + 0.75) / (K + 0.5));
      double slope = 1.0;
      for (int step = 0; step < 20; ++step) {
        double before = 1.0;
        double value = x;
        for (int k = 2; k <= K; ++k) {
          const double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
          before = value;
          value = next;
        }
        slope = K * (x * value - before) / (x * x - 1.0);
        x -= value / slope;
      }
      made.nodes[i] = 0.5 - 0.5 * x;
      made.weights[i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
    return made;
  }();
  return rule;
}

}  // namespace internal

template <int N>
auto ArcMoments<N>::lane_powers(float y) -> Floats {
  Floats powers{};
  float power = 1.0F;
  for (int b = 0; b <= N; ++b) {
    powers[b] = power - (b > 0 ? static_cast<float>(mean_power(b)) : 0.0F);
    power *= y;
  }
  return powers;
}

// Of P_b, 0 at both ends of a row for b above 0.
template <int N>
auto ArcMoments<N>::antiderivative(double y) -> Integers {
  Integers values{};
  constexpr double kScale = 1 << kMomentBits;
  values[0] = static_cast<std::uint32_t>(std::lrint(y * kScale));
  double power = y;
  double half = 0.5;
  for (int b = 1; b <= N; ++b) {
    // y^(b + 1) - (1/2)^(b + 1) for odd b, y (y^b - (1/2)^b) for even b.
    const double value = b % 2 == 1 ? power * y - half * 0.5 : (power - half) * y;
    values[b] = static_cast<std::uint32_t>(std::lrint(value / (b + 1) * kScale));
    power *= y;
    half *= 0.5;
  }
  return values;
}

template <int N>
void ArcMoments<N>::add_across(double begin, double end, int sign) {
  if (std::abs(begin) == 0.5 && begin == -end) {
    across_[0] += static_cast<std::uint32_t>(end > begin ? sign : -sign) << kMomentBits;
    return;
  }
  across_ += (antiderivative(end) - antiderivative(begin)) * static_cast<std::uint32_t>(sign);
}

template <int N>
void ArcMoments<N>::add_inside(const std::array<Floats, N + 1>& sums, int sign) {
  constexpr float kScale = 1 << kMomentBits;
  for (int a = 0; a <= N; ++a) {
    const Floats scaled = sums[a] * (kScale / static_cast<float>(a + 1));
    for (int b = 0; b < kLanes; ++b) {
      // To the nearest, halves away from 0: as far from it for an edge and for its reverse.
      const float half = scaled[b] < 0.0F ? -0.5F : 0.5F;
      inside_[a][b] +=
          static_cast<std::uint32_t>(static_cast<std::int32_t>(scaled[b] + half) * sign);
    }
  }
}

template <int N>
void ArcMoments<N>::add_line(Point2 begin, Point2 end, int sign) {
  // x^(a + 1) P_b has degree 2 N + 1 at the most along a line: this is exact up to N = 4, and
  // beyond the highest powers, of less than 1/2, are off by less than 1e-8.
  constexpr int kPoints = N < 5 ? N + 1 : 6;
  const auto& rule = internal::gauss_rule<kPoints>();
  const auto x0 = static_cast<float>(begin.x);
  const auto y0 = static_cast<float>(begin.y);
  const auto dx = static_cast<float>(end.x - begin.x);
  const auto dy = static_cast<float>(end.y - begin.y);
  std::array<Floats, N + 1> sums{};
  for (int k = 0; k < kPoints; ++k) {
    const auto t = static_cast<float>(rule.nodes[k]);
    const float x = x0 + t * dx;
    Floats term = lane_powers(y0 + t * dy) * (static_cast<float>(rule.weights[k]) * dy * x);
    sums[0] += term;
    for (int a = 1; a <= N; ++a) {
      term *= x;
      sums[a] += term;
    }
  }
  add_inside(sums, sign);
  add_across(begin.y, end.y, sign);
}

template <int N>
void ArcMoments<N>::add_curve(const ParametricCurve& curve, const CellArc& arc, Point2 center,
                              int sign) {
  constexpr int kPoints = N < 5 ? N + 4 : 9;
  const auto& rule = internal::gauss_rule<kPoints>();
  std::array<Floats, N + 1> sums{};
  // Where an arc is bent, or of a high degree, so many powers of t do not do: it is halved.
  int parts = 1;
  if (curve.kind == CurveKind::kBezier) {
    const double turns = static_cast<double>(curve.controls.size()) * (arc.t_end - arc.t_begin);
    while (parts < turns) parts *= 2;
  }
  const auto bend = [&](double t_begin, double t_end) {
    const Point2 a = curve.at(t_begin);
    const Point2 c = curve.at(t_end);
    const Point2 off = curve.at(0.5 * (t_begin + t_end)) - 0.5 * (a + c);
    return std::abs(off.x) + std::abs(off.y);
  };
  constexpr int kMostParts = 256;
  constexpr double kMostBend = 0.06;
  while (parts < kMostParts) {
    const double step = (arc.t_end - arc.t_begin) / parts;
    double most = 0.0;
    for (int part = 0; part < parts; ++part) {
      most = std::max(most, bend(arc.t_begin + part * step, arc.t_begin + (part + 1) * step));
    }
    if (most < kMostBend) break;
    parts *= 2;
  }
  const double step = (arc.t_end - arc.t_begin) / parts;
  for (int part = 0; part < parts; ++part) {
    const double from = arc.t_begin + part * step;
    for (int k = 0; k < kPoints; ++k) {
      const double t = from + rule.nodes[k] * step;
      const Point2 at = curve.at(t) - center;
      const double dy = rule.weights[k] * step * curve.derivative(t).y;
      const auto x = static_cast<float>(at.x);
      Floats term = lane_powers(static_cast<float>(at.y)) * (static_cast<float>(dy) * x);
      sums[0] += term;
      for (int a = 1; a <= N; ++a) {
        term *= x;
        sums[a] += term;
      }
    }
  }
  add_inside(sums, sign);
  add_across(arc.begin.y - center.y, arc.end.y - center.y, sign);
}

template <int N>
bool ArcMoments<N>::is_zero() const {
  Integers any = across_;
  for (const Integers& row : inside_) {
    for (int b = 0; b < kLanes; ++b) any[b] |= row[b];
  }
  for (int b = 0; b < kLanes; ++b) {
    if (any[b] != 0) return false;
  }
  return true;
}

}  // namespace prefilter
