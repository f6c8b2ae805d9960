// SPDX-License-Identifier: GPL-3.0-or-later

// Integrals along arcs in a cell, from which the moments of the region to their right are computed.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "prefilter/base/lanes.h"
#include "prefilter/base/outline.h"
#include "prefilter/geometry/moments/cell_cutter.h"

namespace prefilter {

/// Fixed-point precision of the sums over arcs: multiples of 2^-kMomentBits. Integer sums do not
/// depend on their order; arcs of an edge shared by two shapes cancel exactly; and behind the last
/// arc of a closed contour the sum is exactly 0. Sums are modulo 2^32, so only the final result
/// must fit, which allows up to 32 windings.
inline constexpr int kMomentBits = 26;

/// Sums over the arcs in one cell. Cell coordinates run from -1/2 to 1/2. Moments along y use
/// P_b(y) = y^b minus, for even b above 0, its mean over the cell, so that full rows only affect
/// P_0.
template <int N>
struct ArcMoments {
  static constexpr int kCount = N + 1;
  static constexpr int kAcross = kCount * kCount;
  /// Padded to whole vectors, wherever reading starts.
  static constexpr int kSums =
      (kAcross + (kCount + 1) / 2 * 2 + kMaxChannels - 1) / kMaxChannels * kMaxChannels;

  /// The integrals of x^(a + 1) / (a + 1) P_b(y) dy at [a * kCount + b], followed from kAcross on
  /// by the integrals of P_b(y) dy.
  alignas(16) std::array<std::uint32_t, kSums> sums{};

  std::int32_t inside(int a, int b) const {
    return static_cast<std::int32_t>(sums[a * kCount + b]);
  }
  std::int32_t across(int b) const { return static_cast<std::int32_t>(sums[kAcross + b]); }
  bool is_zero() const;
};

/// A batch of arcs, several of which are integrated at once.
template <int N>
class ArcBatch {
 public:
  using Cells = std::vector<ArcMoments<N>>;

  /// Adds a line, or an arc of a curve, in coordinates of the cell with index `place`. The region
  /// to its right counts `sign` times, 1 or -1.
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
    // A line at x = 0 adds the integrals across only: inside, it adds x^(a + 1) / (a + 1) = 0.
    add_line({0.0, arc.begin.y - center.y}, {0.0, arc.end.y - center.y}, sign, place, cells);
  }
  /// Immediately adds the integrals of an arc inside a cell.
  static void add_inside(const ParametricCurve& curve, const CellArc& arc, Point2 center, int sign,
                         ArcMoments<N>* cell);
  /// Adds all pending arcs to the cells.
  void flush(Cells* cells);

 private:
  static constexpr int kLanes = kMaxChannels;
  // Several vectors long, because reading a vector right after writing its floats is slow.
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

/// Mean of y^b over [-1/2, 1/2], its integral over a cell.
constexpr double mean_power(int b) {
  if (b % 2 != 0) return 0.0;
  double mean = 1.0 / (b + 1);
  for (int i = 0; i < b; ++i) mean *= 0.5;
  return mean;
}

/// x^(a + 1) / (a + 1) at a cell's upper end.
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
