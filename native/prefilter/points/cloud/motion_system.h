// SPDX-License-Identifier: GPL-3.0-or-later

// Least squares for small motions of scans.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

inline constexpr std::size_t kDegreesOfFreedom = 6;  // a rotation, then a translation
inline constexpr double kMinNormalCosine = 0.7;  // smallest cosine between the normals of a pair

using MotionStep = std::array<double, kDegreesOfFreedom>;

/// Distance of a point from a plane of another scan, and its derivatives by the motions of both
/// scans.
struct MotionPair {
  double distance = 0.0;
  MotionStep own{};
  MotionStep other{};
};

/// Derivative of a point's distance from a plane by a small motion; `arm` is the point relative to
/// the center of rotation.
MotionStep derivative(const Vector3& normal, const Vector3& arm);

void add_distances(std::span<const MotionPair> pairs, std::vector<double>* distances);

/// Median of values, which are reordered; 0 if there are none.
double median_of(std::vector<double>* values);

/// Distance at which the weight of pairs reaches 0: a multiple of the standard deviation, estimated
/// from the median.
double cutoff_for(double median, double least);

/// Normal equations for the motions of all scans except the first, which is fixed.
class MotionSystem {
 public:
  explicit MotionSystem(std::size_t scans)
      : size_(kDegreesOfFreedom * (scans - 1)), matrix_(size_ * size_), right_(size_) {}

  void add(std::size_t scan, std::size_t other, std::span<const MotionPair> pairs, double cutoff);

  /// Returns the steps of all scans. Directions that pairs do not determine, such as sliding along
  /// a plane, hardly change.
  std::vector<MotionStep> solve();

 private:
  static constexpr std::size_t kFixed = std::numeric_limits<std::size_t>::max();

  static std::size_t unknown(std::size_t scan, std::size_t freedom) {
    return scan == 0 ? kFixed : kDegreesOfFreedom * (scan - 1) + freedom;
  }
  void damp();
  void factor();

  std::size_t size_;
  std::vector<double> matrix_;
  std::vector<double> right_;
};

}  // namespace prefilter
