// SPDX-License-Identifier: GPL-3.0-or-later

// Weighted least squares with Tukey's biweight, solved by a damped Cholesky factorization.
#include "prefilter/points/cloud/motion_system.h"

#include <algorithm>
#include <cmath>

namespace prefilter {
namespace {

// relative to the mean diagonal of a scan's rotations or translations
constexpr double kDamping = 1e-4;
// Standard deviations at which Tukey's biweight reaches 0, for 95 % efficiency.
constexpr double kTukeyCutoff = 4.685;
// ratio of standard deviation and median of absolute normal deviates
constexpr double kMedianToDeviation = 1.4826;

}  // namespace

MotionStep derivative(const Vector3& normal, const Vector3& arm) {
  const Vector3 turn = cross(arm, normal);
  return {turn[0], turn[1], turn[2], normal[0], normal[1], normal[2]};
}

void add_distances(std::span<const MotionPair> pairs, std::vector<double>* distances) {
  for (const MotionPair& pair : pairs) distances->push_back(std::abs(pair.distance));
}

double median_of(std::vector<double>* values) {
  if (values->empty()) return 0.0;
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

double cutoff_for(double median, double least) {
  return kTukeyCutoff * std::max(kMedianToDeviation * median, least);
}

void MotionSystem::add(std::size_t scan, std::size_t other, std::span<const MotionPair> pairs,
                       double cutoff) {
  std::array<double, 4 * kDegreesOfFreedom * kDegreesOfFreedom> block{};
  std::array<double, 2 * kDegreesOfFreedom> right{};
  for (const MotionPair& pair : pairs) {
    const double share = pair.distance / cutoff;
    if (!(std::abs(share) < 1.0)) continue;
    const double weight = (1.0 - share * share) * (1.0 - share * share);
    std::array<double, 2 * kDegreesOfFreedom> both;
    std::copy(pair.own.begin(), pair.own.end(), both.begin());
    std::copy(pair.other.begin(), pair.other.end(), both.begin() + kDegreesOfFreedom);
    for (std::size_t r = 0; r < both.size(); ++r) {
      right[r] -= weight * both[r] * pair.distance;
      for (std::size_t c = 0; c < both.size(); ++c) {
        block[r * both.size() + c] += weight * both[r] * both[c];
      }
    }
  }
  const std::size_t scans[2] = {scan, other};
  for (std::size_t r = 0; r < right.size(); ++r) {
    const std::size_t row = unknown(scans[r / kDegreesOfFreedom], r % kDegreesOfFreedom);
    if (row == kFixed) continue;
    right_[row] += right[r];
    for (std::size_t c = 0; c < right.size(); ++c) {
      const std::size_t column = unknown(scans[c / kDegreesOfFreedom], c % kDegreesOfFreedom);
      if (column != kFixed) matrix_[row * size_ + column] += block[r * right.size() + c];
    }
  }
}

std::vector<MotionStep> MotionSystem::solve() {
  damp();
  factor();
  for (std::size_t r = 0; r < size_; ++r) {
    for (std::size_t k = 0; k < r; ++k) right_[r] -= matrix_[r * size_ + k] * right_[k];
    right_[r] /= matrix_[r * size_ + r];
  }
  for (std::size_t r = size_; r-- > 0;) {
    for (std::size_t k = r + 1; k < size_; ++k) right_[r] -= matrix_[k * size_ + r] * right_[k];
    right_[r] /= matrix_[r * size_ + r];
  }
  std::vector<MotionStep> steps(size_ / kDegreesOfFreedom + 1);
  for (std::size_t i = 0; i < size_; ++i)
    steps[i / kDegreesOfFreedom + 1][i % kDegreesOfFreedom] = right_[i];
  return steps;
}

void MotionSystem::damp() {
  constexpr std::size_t kAxes = 3;
  for (std::size_t begin = 0; begin < size_; begin += kAxes) {
    double sum = 0.0;
    for (std::size_t i = begin; i < begin + kAxes; ++i) sum += matrix_[i * size_ + i];
    const double more = sum > 0.0 ? kDamping * sum / kAxes : 1.0;
    for (std::size_t i = begin; i < begin + kAxes; ++i) matrix_[i * size_ + i] += more;
  }
}

// Cholesky factor, in the lower triangle.
void MotionSystem::factor() {
  for (std::size_t r = 0; r < size_; ++r) {
    for (std::size_t c = 0; c <= r; ++c) {
      double sum = matrix_[r * size_ + c];
      for (std::size_t k = 0; k < c; ++k) sum -= matrix_[r * size_ + k] * matrix_[c * size_ + k];
      if (c < r) {
        matrix_[r * size_ + c] = sum / matrix_[c * size_ + c];
      } else {
        matrix_[r * size_ + r] = std::sqrt(std::max(sum, std::numeric_limits<double>::min()));
      }
    }
  }
}

}  // namespace prefilter
