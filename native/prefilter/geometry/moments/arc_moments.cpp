// SPDX-License-Identifier: GPL-3.0-or-later

// Green's theorem: moments of a region from integrals along its border.
#include "prefilter/geometry/moments/arc_moments.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "prefilter/base/gauss_rule.h"
#include "prefilter/base/lanes.h"

namespace prefilter {
namespace {

using IntegerLanes = Vector<std::int32_t, kMaxChannels>;
using BitLanes = Vector<std::uint32_t, kMaxChannels>;

inline Lanes lanes_at(const float* values) {
  Lanes lanes;
  std::memcpy(&lanes, values, sizeof lanes);
  return lanes;
}

// Rounds to the nearest, halves away from 0, so that an edge and its reverse cancel.
inline IntegerLanes rounded(Lanes values) {
  return convert<IntegerLanes>(select(values < 0.0F, values - 0.5F, values + 0.5F));
}

// Rounds down after adding `share`, in [0, 1), to the magnitude. If the share is pseudorandom, sums
// of arcs much smaller than the unit are unbiased.
inline IntegerLanes rounded(Lanes values, Lanes share) {
  return convert<IntegerLanes>(select(values < 0.0F, values - share, values + share));
}

// Pseudorandom, and equal for an edge and its reverse, which are cut at the same points.
inline Lanes share_of(Lanes x, Lanes y) {
  BitLanes bits =
      std::bit_cast<BitLanes>(x) * 0x9E3779B1U ^ std::bit_cast<BitLanes>(y) * 0x85EBCA77U;
  bits ^= bits >> 15;
  bits *= 0xC2B2AE3DU;
  return convert<Lanes>(std::bit_cast<IntegerLanes>(bits >> 8)) * 0x1p-24F;
}

// Transposes four vectors in place.
inline void transpose(IntegerLanes* rows) {
  const IntegerLanes a = shuffle<0, 4, 1, 5>(rows[0], rows[1]);
  const IntegerLanes b = shuffle<2, 6, 3, 7>(rows[0], rows[1]);
  const IntegerLanes c = shuffle<0, 4, 1, 5>(rows[2], rows[3]);
  const IntegerLanes d = shuffle<2, 6, 3, 7>(rows[2], rows[3]);
  rows[0] = shuffle<0, 1, 4, 5>(a, c);
  rows[1] = shuffle<2, 3, 6, 7>(a, c);
  rows[2] = shuffle<0, 1, 4, 5>(b, d);
  rows[3] = shuffle<2, 3, 6, 7>(b, d);
}

constexpr float kScale = 1 << kMomentBits;

// Antiderivatives of P_b, which for b above 0 vanish at both ends of a row: y^(b + 1) - (1/2)^(b +
// 1) for odd b, y (y^b - (1/2)^b) for even b, divided by b + 1.
template <std::size_t kCount>
void antiderivatives(Lanes y, std::array<IntegerLanes, kCount>* values) {
  (*values)[0] = rounded(y * kScale);
  Lanes power = y;
  float half = 0.5F;
  for (std::size_t b = 1; b < kCount; ++b) {
    const Lanes value = b % 2 == 1 ? power * y - half * 0.5F : (power - half) * y;
    (*values)[b] = rounded(value * (kScale / static_cast<float>(b + 1)));
    power *= y;
    half *= 0.5F;
  }
}

// Adds the integrals of x^(a + 1) P_b(y) dy along lines, one per lane, at [a * (N + 1) + b].
template <int N>
inline void integrate_lines(Lanes x0, Lanes y0, Lanes x1, Lanes y1, Lanes signs, Lanes* sums) {
  // Along a line x^(a + 1) P_b has a degree of at most 2 N + 1. The rule is exact up to N = 4;
  // beyond, the error of the highest powers, with arguments of at most 1/2, is below 1e-8.
  constexpr int kPoints = N < 5 ? N + 1 : 6;
  constexpr int kCount = N + 1;
  const auto& rule = gauss_rule<kPoints>();
  const Lanes dx = x1 - x0;
  const Lanes dy = y1 - y0;
  const Lanes weight = dy * signs;
  for (int k = 0; k < kPoints; ++k) {
    const auto t = static_cast<float>(rule.nodes[k]);
    const Lanes x = x0 + dx * t;
    const Lanes y = y0 + dy * t;
    Lanes powers[kCount];
    Lanes power = weight * static_cast<float>(rule.weights[k]) * x;
    const Lanes level = power;
    for (int b = 0; b < kCount; ++b) {
      powers[b] = b > 0 ? power - level * static_cast<float>(mean_power(b)) : power;
      power *= y;
    }
    for (int a = 0; a < kCount; ++a) {
      for (int b = 0; b < kCount; ++b) {
        sums[a * kCount + b] += powers[b];
        powers[b] *= x;
      }
    }
  }
}

// The number of parts into which to divide an arc: it is halved until it is straight enough for the
// quadrature. Inline, because a function call takes a third longer per arc.
inline int parts_of(const ParametricCurve& curve, const CellArc& arc) {
  constexpr int kMaxParts = 256;
  constexpr double kMaxBend = 0.06;
  constexpr double kMaxConicStep = 0.25;  // parameter range over which a conic is nearly polynomial
  int parts = curve.kind == CurveKind::kConic && arc.t_end - arc.t_begin > kMaxConicStep ? 2 : 1;
  if (curve.kind == CurveKind::kBezier) {
    const double turns = static_cast<double>(curve.controls.size()) * (arc.t_end - arc.t_begin);
    while (parts < turns) parts *= 2;
  }
  const auto bend = [&](double t_begin, double t_end) {
    const double t = 0.5 * (t_begin + t_end);
    if (curve.kind == CurveKind::kConic || curve.kind == CurveKind::kBezier) {
      const bool is_whole = parts == 1;
      const Point2 a = is_whole ? arc.begin : curve.at(t_begin);
      const Point2 c = is_whole ? arc.end : curve.at(t_end);
      const Point2 off = curve.at(t) - 0.5 * (a + c);
      return std::abs(off.x) + std::abs(off.y);
    }
    // For polynomials up to degree 3, the second derivative at the center suffices.
    const double half = 0.5 * (t_end - t_begin);
    const Point2 off = (half * half) * (curve.powers[2] + (3.0 * t) * curve.powers[3]);
    return std::abs(off.x) + std::abs(off.y);
  };
  while (parts < kMaxParts) {
    const double step = (arc.t_end - arc.t_begin) / parts;
    double most = 0.0;
    for (int part = 0; part < parts; ++part) {
      most = std::max(most, bend(arc.t_begin + part * step, arc.t_begin + (part + 1) * step));
    }
    if (most < kMaxBend) break;
    parts *= 2;
  }
  return parts;
}

// Calls use(point, slope of y, weight) for the nodes of a quadrature rule over [from, from + step].
template <int kPoints, typename Use>
inline void for_nodes(const ParametricCurve& curve, double from, double step, const Use& use) {
  const auto& rule = gauss_rule<kPoints>();
  if (curve.kind == CurveKind::kBezier) {
    for (int k = 0; k < kPoints; ++k) {
      const double t = from + rule.nodes[k] * step;
      const Point2 point = curve.at(t);
      use(point, curve.derivative(t, point).y, rule.weights[k]);
    }
    return;
  }
  for (int k = 0; k < kPoints; k += 2) {
    // The last of an odd number of nodes is evaluated twice.
    const int next = k + 1 < kPoints ? k + 1 : k;
    const DoublePair nodes{rule.nodes[k], rule.nodes[next]};
    const ParametricCurve::Pair pair = curve.pair_at(from + nodes * step);
    use({pair.x[0], pair.y[0]}, pair.y_slope[0], rule.weights[k]);
    if (next > k) use({pair.x[1], pair.y[1]}, pair.y_slope[1], rule.weights[next]);
  }
}

}  // namespace

template <int N>
void ArcBatch<N>::flush(Cells* cells) {
  for (int first = 0; first < size_; first += kLanes) flush_lanes(first, cells);
  size_ = 0;
}

template <int N>
void ArcBatch<N>::flush_lanes(int first, Cells* cells) {
  const Lanes x0 = lanes_at(&x0_[first]);
  const Lanes y0 = lanes_at(&y0_[first]);
  const Lanes x1 = lanes_at(&x1_[first]);
  const Lanes y1 = lanes_at(&y1_[first]);
  const Lanes signs = lanes_at(&signs_[first]);
  Lanes sums[kCount * kCount] = {};
  integrate_lines<N>(x0, y0, x1, y1, signs, sums);
  // Sums of each arc in the layout of the cells, one arc per lane.
  IntegerLanes whole[ArcMoments<N>::kSums] = {};
  const Lanes share = share_of(x1, y1);
  for (int a = 0; a < kCount; ++a) {
    const float scale = kScale / static_cast<float>(a + 1);
    for (int b = 0; b < kCount; ++b) {
      whole[a * kCount + b] = rounded(sums[a * kCount + b] * scale, share);
    }
  }
  std::array<IntegerLanes, kCount> before;
  std::array<IntegerLanes, kCount> after;
  antiderivatives(y0, &before);
  antiderivatives(y1, &after);
  const IntegerLanes whole_signs = rounded(signs);
  for (int b = 0; b < kCount; ++b) {
    whole[ArcMoments<N>::kAcross + b] = (after[b] - before[b]) * whole_signs;
  }
  for (int j = 0; j < ArcMoments<N>::kSums; j += kLanes) transpose(whole + j);
  const int count = std::min(kLanes, size_ - first);
  for (int i = 0; i < count; ++i) {
    std::uint32_t* cell = (*cells)[places_[first + i]].sums.data();
    for (int j = 0; j < ArcMoments<N>::kSums; j += kLanes) {
      BitLanes sum;
      std::memcpy(&sum, cell + j, sizeof sum);
      sum += std::bit_cast<BitLanes>(whole[j + i]);
      std::memcpy(cell + j, &sum, sizeof sum);
    }
  }
}

template <int N>
void ArcBatch<N>::add_inside(const ParametricCurve& curve, const CellArc& arc, Point2 center,
                             int sign, ArcMoments<N>* cell) {
  constexpr int kPoints = N < 5 ? N + 4 : 9;
  std::array<float, kCount * kCount> sums{};
  const int parts = parts_of(curve, arc);
  const double step = (arc.t_end - arc.t_begin) / parts;
  for (int part = 0; part < parts; ++part) {
    const double from = arc.t_begin + part * step;
    const auto add_node = [&](const Point2& point, double y_slope, double weight) {
      const Point2 at = point - center;
      const auto x = static_cast<float>(at.x);
      const auto y = static_cast<float>(at.y);
      auto factor = static_cast<float>(weight * step * y_slope);
      std::array<float, kCount> powers;
      float power = 1.0F;
      for (int b = 0; b < kCount; ++b) {
        powers[b] = power - (b > 0 ? static_cast<float>(mean_power(b)) : 0.0F);
        power *= y;
      }
      for (int a = 0; a < kCount; ++a) {
        factor *= x;
        for (int b = 0; b < kCount; ++b) sums[a * kCount + b] += factor * powers[b];
      }
    };
    for_nodes<kPoints>(curve, from, step, add_node);
  }
  for (int a = 0; a < kCount; ++a) {
    for (int b = 0; b < kCount; ++b) {
      const float scaled = sums[a * kCount + b] * (kScale / static_cast<float>(a + 1));
      const auto whole = static_cast<std::int32_t>(scaled + std::copysign(0.5F, scaled));
      cell->sums[a * kCount + b] += static_cast<std::uint32_t>(whole * sign);
    }
  }
}

template class ArcBatch<0>;
template class ArcBatch<1>;
template class ArcBatch<2>;
template class ArcBatch<3>;
template class ArcBatch<4>;
template class ArcBatch<5>;
template class ArcBatch<7>;
template class ArcBatch<8>;
template class ArcBatch<9>;

}  // namespace prefilter
