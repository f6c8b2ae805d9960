// SPDX-License-Identifier: GPL-3.0-or-later

// Small motions of scans by pairs of what belongs together.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

inline constexpr std::size_t kFreedom = 6;  // a turn, then a shift
inline constexpr double kAgreement = 0.7;   // the cosine of normals of a pair, at the least

using MotionStep = std::array<double, kFreedom>;

/// A point of one scan, how far it is from the plane of another's, and what a small motion of
/// either does to that.
struct MotionPair {
  double distance = 0.0;
  MotionStep own{};
  MotionStep other{};
};

/// What a small motion of a point does to its distance from a plane; `arm` is from the center of
/// its turn.
MotionStep derivative(const Vector3& normal, const Vector3& arm);

void add_distances(std::span<const MotionPair> pairs, std::vector<double>* distances);

/// Of values in any order, which change theirs; 0 of none.
double median_of(std::vector<double>* values);

/// The distance from which on pairs have no weight: so many standard deviations, by the median.
double cutoff_for(double median, double least);

/// The least squares of the motions of all scans but the first.
class MotionSystem {
 public:
  explicit MotionSystem(std::size_t scans)
      : size_(kFreedom * (scans - 1)), matrix_(size_ * size_), right_(size_) {}

  void add(std::size_t scan, std::size_t other, std::span<const MotionPair> pairs, double cutoff);

  /// The steps of all scans. What pairs say little about, such as the way along a plane, hardly
  /// changes.
  std::vector<MotionStep> solve();

 private:
  static constexpr std::size_t kFixed = std::numeric_limits<std::size_t>::max();

  static std::size_t unknown(std::size_t scan, std::size_t freedom) {
    return scan == 0 ? kFixed : kFreedom * (scan - 1) + freedom;
  }
  void damp();
  void factor();

  std::size_t size_;
  std::vector<double> matrix_;
  std::vector<double> right_;
};

}  // namespace prefilter
