// SPDX-License-Identifier: GPL-3.0-or-later

// The integrals along an arc in a cell that the moments of what lies right of it are made of.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "prefilter/base/lanes.h"
#include "prefilter/base/outline.h"
#include "prefilter/geometry/moments/cell_cutter.h"

namespace prefilter {

/// Sums over the arcs in a cell, in fractions of 2^-kMomentBits. Whole numbers add up to the same
/// in any order; the arcs of an edge that two shapes share cancel; and what a closed contour leaves
/// behind its last arc is 0. They are added modulo 2^32: only what comes out needs to fit, which is
/// up to 32 windings.
inline constexpr int kMomentBits = 26;

/// What arcs leave in one cell. Coordinates in it run from -1/2 to 1/2 around its center. Along y
/// moments are those of P_b(y) = y^b less its mean over the cell for even b above 0, so that P_0
/// alone tells a full row.
template <int N>
struct ArcMoments {
  static constexpr int kCount = N + 1;
  static constexpr int kAcross = kCount * kCount;
  /// Whole vectors of them, wherever in them one is read from.
  static constexpr int kSums =
      (kAcross + (kCount + 1) / 2 * 2 + kMaxChannels - 1) / kMaxChannels * kMaxChannels;

  /// The integrals of x^(a + 1) / (a + 1) P_b(y) dy at [a * kCount + b], and from kAcross on those
  /// of P_b(y) dy.
  alignas(16) std::array<std::uint32_t, kSums> sums{};

  std::int32_t inside(int a, int b) const {
    return static_cast<std::int32_t>(sums[a * kCount + b]);
  }
  std::int32_t across(int b) const { return static_cast<std::int32_t>(sums[kAcross + b]); }
  bool is_zero() const;
};

/// Arcs on their way to cells, several of which are calculated at once.
template <int N>
class ArcBatch {
 public:
  using Cells = std::vector<ArcMoments<N>>;

  /// Adds a line, or an arc of a curve, in coordinates of the cell at `place`; the region on its
  /// right counts `sign` times, 1 or -1.
  void add_line(Point2 begin, Point2 end, int sign, std::int32_t place, Cells* cells) {
    x0_[size_] = static_cast<float>(begin.x);
    y0_[size_] = static_cast<float>(begin.y);
    x1_[size_] = static_cast<float>(end.x);
    y1_[size_] = static_cast<float>(end.y);
    signs_[size_] = static_cast<float>(sign);
    places_[size_] = place;
    if (++size_ == kSize) flush(cells);
  }
  void add_curve(const ParametricCurve& curve, const CellArc& arc, Point2 center, int sign,
                 std::int32_t place, Cells* cells) {
    add_inside(curve, arc, center, sign, &(*cells)[place]);
    // The lane has no extent along x and stands for what is across alone; what that adds inside is
    // x^(a + 1) / (a + 1) at 0, which is nothing.
    add_line({0.0, arc.begin.y - center.y}, {0.0, arc.end.y - center.y}, sign, place, cells);
  }
  /// What an arc of a curve adds inside of a cell, at once.
  static void add_inside(const ParametricCurve& curve, const CellArc& arc, Point2 center, int sign,
                         ArcMoments<N>* cell);
  /// What was added may only then be in the cells.
  void flush(Cells* cells);

 private:
  static constexpr int kLanes = kMaxChannels;
  // More than are calculated at once: what has just been written, float by float, is slow to read
  // as a vector.
  static constexpr int kSize = 16 * kLanes;
  static constexpr int kCount = N + 1;

  void flush_lanes(int first, Cells* cells);

  int size_ = 0;
  std::array<float, kSize> x0_{};
  std::array<float, kSize> y0_{};
  std::array<float, kSize> x1_{};
  std::array<float, kSize> y1_{};
  std::array<float, kSize> signs_{};
  std::array<std::int32_t, kSize> places_{};
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

template <int N>
bool ArcMoments<N>::is_zero() const {
  std::uint32_t any = 0;
  for (const std::uint32_t sum : sums) any |= sum;
  return any == 0;
}

extern template class ArcBatch<0>;
extern template class ArcBatch<1>;
extern template class ArcBatch<2>;
extern template class ArcBatch<3>;
extern template class ArcBatch<4>;
extern template class ArcBatch<5>;
extern template class ArcBatch<7>;
extern template class ArcBatch<8>;
extern template class ArcBatch<9>;

}  // namespace prefilter
