// SPDX-License-Identifier: GPL-3.0-or-later

// Chen and Medioni, Object modelling by registration of multiple range images (1992): distances to
// planes instead of points; all scans at once, as in Bergevin et al., Towards a general multi-view
// registration technique (1996).
#include "prefilter/cloud/align_scans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/cloud/moved_scan.h"

namespace prefilter {
namespace {

constexpr int kMostIterations = 1000;
constexpr double kReachShare = 0.05;  // of the diagonal
constexpr double kShrinking = 0.7;    // of the reach, from one iteration to the next
constexpr double kLeastReach = 4.0;   // in spacings
constexpr double kAgreement = 0.7;    // the cosine of normals
// Searches in all, and samples of a scan.
constexpr std::size_t kPairs = 1'000'000;
constexpr std::size_t kLeastSamples = 1'000;
constexpr std::size_t kMostSamples = 20'000;
// Beyond so many standard deviations a pair has no weight (Tukey's for 95 % efficiency).
constexpr double kCutoff = 4.685;
constexpr double kDeviation = 1.4826;  // of the median of distances that are normally distributed
constexpr double kDamping = 1e-4;      // relative to a scan's own mean diagonal
constexpr double kStill = 1e-4;        // a motion so small, in spacings, is none
constexpr std::size_t kFreedom = 6;    // a turn, then a shift

using Step = std::array<double, kFreedom>;

// A point of one scan, how far it is from the plane of another's, and what a small motion of
// either does to that.
struct Pair {
  double distance = 0.0;
  Step own{};
  Step other{};
};

// What one scan finds in another.
struct PairsOf {
  std::size_t scan = 0;
  std::size_t other = 0;
  std::vector<Pair> pairs;
};

Step derivative(const Vector3& normal, const Vector3& arm) {
  const Vector3 turn = cross(arm, normal);
  return {turn[0], turn[1], turn[2], normal[0], normal[1], normal[2]};
}

void check(std::span<const ScanView> scans, const AlignOptions& options) {
  if (scans.size() < 2) {
    throw_invalid("scans: found " + std::to_string(scans.size()) + "; two are needed");
  }
  for (const ScanView& scan : scans) {
    if (scan.normals.size() != scan.positions.size()) {
      throw_invalid("scans: " + std::to_string(scan.normals.size()) + " normals for " +
                    std::to_string(scan.positions.size()) + " points; one for each is needed");
    }
  }
  if (options.reach && !(*options.reach > 0.0 && std::isfinite(*options.reach))) {
    throw_invalid("reach: found " + to_text(*options.reach) + "; a number above 0 is needed");
  }
  if (options.iterations < 1 || options.iterations > kMostIterations) {
    throw_invalid("iterations: found " + std::to_string(options.iterations) +
                  "; a number from 1 to " + std::to_string(kMostIterations) + " is needed");
  }
}

Box box_of(std::span<const ScanView> scans) {
  constexpr double kLargest = 1e150;
  Box box = kEmptyBox;
  for (const ScanView& scan : scans) {
    for (const Vector3& point : scan.positions) {
      const bool is_usable = std::abs(point[0]) <= kLargest && std::abs(point[1]) <= kLargest &&
                             std::abs(point[2]) <= kLargest;
      if (is_usable) box.include(point);
    }
  }
  return box.low[0] <= box.high[0] ? box : Box{};
}

double median(std::vector<double>* values) {
  if (values->empty()) return 0.0;
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

double median_distance(const std::vector<PairsOf>& all) {
  std::vector<double> distances;
  for (const PairsOf& found : all) {
    for (const Pair& pair : found.pairs) distances.push_back(std::abs(pair.distance));
  }
  return median(&distances);
}

// The pairs of a sample's scan and another one.
std::vector<Pair> find_pairs(const MovedScan& scan, std::span<const std::uint32_t> samples,
                             const MovedScan& other, double reach) {
  std::vector<Pair> pairs;
  if (other.is_empty()) return pairs;
  const Vector3 center = moved(scan.motion, scan.center());
  const Vector3 other_center = moved(other.motion, other.center());
  for (const std::uint32_t place : samples) {
    const Vector3 point = moved(scan.motion, scan.position(place));
    const Vector3 there = moved_back(other.motion, point);
    const std::uint32_t near = other.search().nearest(there, reach * reach);
    if (near == NeighborSearch::kNowhere) continue;
    const Vector3 normal = turned(other.motion, other.normal(near));
    if (std::abs(dot(normal, turned(scan.motion, scan.normal(place)))) < kAgreement) continue;
    const Vector3 offset = there - other.position(near);
    const double distance = dot(other.normal(near), offset);
    const Vector3 aside = offset - distance * other.normal(near);
    // On a border what is nearest lies aside.
    if (length(aside) > other.spacing() + 0.5 * std::abs(distance)) continue;
    const Vector3 at = moved(other.motion, other.position(near));
    pairs.push_back({distance, derivative(normal, point - center),
                     derivative(Vector3{} - normal, at - other_center)});
  }
  return pairs;
}

// The system of least squares of the motions of all scans but the first.
class MotionSystem {
 public:
  explicit MotionSystem(std::size_t scans)
      : size_(kFreedom * (scans - 1)), matrix_(size_ * size_), right_(size_) {}

  void add(const PairsOf& found, double cutoff) {
    std::array<double, 4 * kFreedom * kFreedom> block{};
    std::array<double, 2 * kFreedom> right{};
    for (const Pair& pair : found.pairs) {
      const double share = pair.distance / cutoff;
      if (!(std::abs(share) < 1.0)) continue;
      const double weight = (1.0 - share * share) * (1.0 - share * share);
      std::array<double, 2 * kFreedom> both;
      std::copy(pair.own.begin(), pair.own.end(), both.begin());
      std::copy(pair.other.begin(), pair.other.end(), both.begin() + kFreedom);
      for (std::size_t r = 0; r < both.size(); ++r) {
        right[r] -= weight * both[r] * pair.distance;
        for (std::size_t c = 0; c < both.size(); ++c) {
          block[r * both.size() + c] += weight * both[r] * both[c];
        }
      }
    }
    const std::size_t scans[2] = {found.scan, found.other};
    for (std::size_t r = 0; r < right.size(); ++r) {
      const std::size_t row = unknown(scans[r / kFreedom], r % kFreedom);
      if (row == kFixed) continue;
      right_[row] += right[r];
      for (std::size_t c = 0; c < right.size(); ++c) {
        const std::size_t column = unknown(scans[c / kFreedom], c % kFreedom);
        if (column != kFixed) matrix_[row * size_ + column] += block[r * right.size() + c];
      }
    }
  }

  // The steps of all scans. What pairs say little about, such as the way along a plane, hardly
  // changes.
  std::vector<Step> solve() {
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
    std::vector<Step> steps(size_ / kFreedom + 1);
    for (std::size_t i = 0; i < size_; ++i) steps[i / kFreedom + 1][i % kFreedom] = right_[i];
    return steps;
  }

 private:
  static constexpr std::size_t kFixed = std::numeric_limits<std::size_t>::max();

  static std::size_t unknown(std::size_t scan, std::size_t freedom) {
    return scan == 0 ? kFixed : kFreedom * (scan - 1) + freedom;
  }

  void damp() {
    constexpr std::size_t kAxes = 3;
    for (std::size_t begin = 0; begin < size_; begin += kAxes) {
      double sum = 0.0;
      for (std::size_t i = begin; i < begin + kAxes; ++i) sum += matrix_[i * size_ + i];
      const double more = sum > 0.0 ? kDamping * sum / kAxes : 1.0;
      for (std::size_t i = begin; i < begin + kAxes; ++i) matrix_[i * size_ + i] += more;
    }
  }

  // Cholesky's factor, in the lower half.
  void factor() {
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

  std::size_t size_;
  std::vector<double> matrix_;
  std::vector<double> right_;
};

class Aligner {
 public:
  Aligner(std::span<const ScanView> scans, const AlignOptions& options)
      : threads_(options.threads) {
    const Box box = box_of(scans);
    for (std::size_t a = 0; a < 3; ++a)
      origin_[a] = box.low[a] + 0.5 * box.size(static_cast<int>(a));
    reach_ = options.reach.value_or(kReachShare * length(box.high - box.low));
    const double count = static_cast<double>(scans.size());
    for (std::size_t s = 0; s < scans.size(); ++s) {
      const Progress part = options.progress.part(kReading * static_cast<double>(s) / count,
                                                  kReading * static_cast<double>(s + 1) / count);
      scans_.emplace_back(scans[s], origin_, part, threads_);
    }
    const std::size_t each = kPairs / (scans.size() * (scans.size() - 1));
    for (const MovedScan& scan : scans_) {
      samples_.push_back(scan.samples(std::clamp(each, kLeastSamples, kMostSamples)));
      spacing_ = std::max(spacing_, scan.spacing());
    }
    least_reach_ = std::min(reach_, kLeastReach * spacing_);
  }

  Alignment align(int iterations, const Progress& progress) {
    Alignment result;
    result.before = median_distance(pairs(least_reach_, progress.part(kReading, kFirst)));
    double reach = reach_;
    for (int k = 0; k < iterations; ++k) {
      const double done = static_cast<double>(k) / iterations;
      const Progress part = progress.part(kFirst + (kLast - kFirst) * done,
                                          kFirst + (kLast - kFirst) * (done + 1.0 / iterations));
      const double moved = step(pairs(reach, part));
      if (reach <= least_reach_ && moved < kStill * spacing_) break;
      reach = std::max(least_reach_, kShrinking * reach);
    }
    const std::vector<PairsOf> last = pairs(least_reach_, progress.part(kLast, 1.0));
    result.after = median_distance(last);
    result.pairs.resize(scans_.size());
    for (const PairsOf& found : last) result.pairs[found.scan] += found.pairs.size();
    for (const MovedScan& scan : scans_) result.motions.push_back(from_world(scan.motion));
    progress.report(1.0);
    return result;
  }

 private:
  // Shares of the work: of reading the scans, and of the first and last look at pairs.
  static constexpr double kReading = 0.2;
  static constexpr double kFirst = 0.22;
  static constexpr double kLast = 0.98;

  std::vector<PairsOf> pairs(double reach, const Progress& progress) const {
    std::vector<PairsOf> all;
    for (std::size_t s = 0; s < scans_.size(); ++s) {
      for (std::size_t o = 0; o < scans_.size(); ++o) {
        if (s != o) all.push_back({s, o, {}});
      }
    }
    parallel_for(static_cast<std::int64_t>(all.size()), threads_, progress, [&](std::int64_t i) {
      PairsOf& found = all[static_cast<std::size_t>(i)];
      found.pairs =
          find_pairs(scans_[found.scan], samples_[found.scan], scans_[found.other], reach);
    });
    return all;
  }

  // Moves all scans; returns how far the farthest point of one went, about.
  double step(const std::vector<PairsOf>& all) {
    const double deviation = kDeviation * median_distance(all);
    const double cutoff = kCutoff * std::max(deviation, kStill * spacing_);
    MotionSystem system(scans_.size());
    for (const PairsOf& found : all) system.add(found, cutoff);
    const std::vector<Step> steps = system.solve();
    double farthest = 0.0;
    for (std::size_t s = 1; s < scans_.size(); ++s) {
      MovedScan& scan = scans_[s];
      if (scan.is_empty()) continue;
      const Vector3 turn = {steps[s][0], steps[s][1], steps[s][2]};
      const Vector3 shift = {steps[s][3], steps[s][4], steps[s][5]};
      const RigidMotion more = small_motion(turn, shift, moved(scan.motion, scan.center()));
      scan.motion = then(scan.motion, more);
      const Box box = scan.search().box();
      farthest = std::max(farthest, length(shift) + length(turn) * length(box.high - box.low));
    }
    return farthest;
  }

  // The same in the coordinates of the scans, which are not relative to the origin.
  RigidMotion from_world(const RigidMotion& motion) const {
    RigidMotion result = motion;
    result.shift = motion.shift + (origin_ - turned(motion, origin_));
    return result;
  }

  int threads_;
  Vector3 origin_{};
  double reach_ = 0.0;
  double least_reach_ = 0.0;
  double spacing_ = 0.0;
  std::vector<MovedScan> scans_;
  std::vector<std::vector<std::uint32_t>> samples_;
};

}  // namespace

Alignment align_scans(std::span<const ScanView> scans, const AlignOptions& options) {
  check(scans, options);
  return Aligner(scans, options).align(options.iterations, options.progress);
}

}  // namespace prefilter
