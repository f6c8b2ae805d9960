// SPDX-License-Identifier: GPL-3.0-or-later

// Point-to-plane registration by Chen and Medioni, Object modelling by registration of multiple
// range images (1992), of all scans at once as in Bergevin et al., Towards a general multi-view
// registration technique (1996).
#include "prefilter/points/align_scans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/points/cloud/motion_system.h"
#include "prefilter/points/cloud/moved_scan.h"

namespace prefilter {
namespace {

constexpr double kReachShare = 0.05;  // of the diagonal
constexpr double kReachDecay = 0.7;   // of the reach per iteration
// Searches per iteration, and samples per scan.
constexpr std::size_t kTotalSamples = 1'000'000;
constexpr std::size_t kMinSamples = 1'000;

// Pairs between one scan and another.
struct ScanPairs {
  std::size_t scan = 0;
  std::size_t other = 0;
  std::vector<MotionPair> pairs;
};

double median_distance(const std::vector<ScanPairs>& all) {
  std::vector<double> distances;
  for (const ScanPairs& scan_pairs : all) add_distances(scan_pairs.pairs, &distances);
  return median_of(&distances);
}

// Pairs samples of a scan with points of another scan.
std::vector<MotionPair> find_pairs(const MovedScan& scan, std::span<const std::uint32_t> samples,
                                   const MovedScan& other, double reach) {
  std::vector<MotionPair> pairs;
  if (other.is_empty()) return pairs;
  const Vector3 center = moved(scan.motion, scan.center());
  const Vector3 other_center = moved(other.motion, other.center());
  for (const std::uint32_t place : samples) {
    const Vector3 point = moved(scan.motion, scan.position(place));
    const Vector3 there = moved_back(other.motion, point);
    const std::uint32_t near = other.search().nearest(there, reach * reach);
    if (near == NeighborSearch::kNowhere) continue;
    const Vector3 normal = turned(other.motion, other.normal(near));
    if (std::abs(dot(normal, turned(scan.motion, scan.normal(place)))) < kMinNormalCosine) continue;
    const Vector3 offset = there - other.position(near);
    const double distance = dot(other.normal(near), offset);
    const Vector3 aside = offset - distance * other.normal(near);
    // Beyond a border, the nearest point lies sideways.
    if (length(aside) > other.spacing() + 0.5 * std::abs(distance)) continue;
    const Vector3 at = moved(other.motion, other.position(near));
    pairs.push_back({distance, derivative(normal, point - center),
                     derivative(Vector3{} - normal, at - other_center)});
  }
  return pairs;
}

class Aligner {
 public:
  Aligner(std::span<const ScanView> scans, const AlignOptions& options)
      : threads_(options.run.threads()) {
    const Box box = box_of(scans);
    origin_ = middle_of(box);
    reach_ = options.reach.value_or(kReachShare * length(box.high - box.low));
    const double count = static_cast<double>(scans.size());
    for (std::size_t s = 0; s < scans.size(); ++s) {
      const Run part = options.run.part(kReadProgress * static_cast<double>(s) / count,
                                        kReadProgress * static_cast<double>(s + 1) / count);
      scans_.emplace_back(scans[s], origin_, part);
    }
    const std::size_t each = kTotalSamples / (scans.size() * (scans.size() - 1));
    for (const MovedScan& scan : scans_) {
      samples_.push_back(scan.samples(std::clamp(each, kMinSamples, kMaxSamples)));
      spacing_ = std::max(spacing_, scan.spacing());
    }
    least_reach_ = std::min(reach_, kMinReach * spacing_);
  }

  Alignment align(int iterations, const Run& run) {
    Alignment result;
    result.before =
        median_distance(pairs(least_reach_, run.part(kReadProgress, kFirstPairsProgress)));
    double reach = reach_;
    for (int k = 0; k < iterations; ++k) {
      const double done = static_cast<double>(k) / iterations;
      const Run part =
          run.part(kFirstPairsProgress + (kLastPairsProgress - kFirstPairsProgress) * done,
                   kFirstPairsProgress +
                       (kLastPairsProgress - kFirstPairsProgress) * (done + 1.0 / iterations));
      const double moved = step(pairs(reach, part));
      if (reach <= least_reach_ && moved < kMinMotion * spacing_) break;
      reach = std::max(least_reach_, kReachDecay * reach);
    }
    const std::vector<ScanPairs> last = pairs(least_reach_, run.part(kLastPairsProgress, 1.0));
    result.after = median_distance(last);
    result.pairs.resize(scans_.size());
    for (const ScanPairs& scan_pairs : last)
      result.pairs[scan_pairs.scan] += scan_pairs.pairs.size();
    for (const MovedScan& scan : scans_)
      result.motions.push_back(relative_to(scan.motion, Vector3{} - origin_));
    run.report(1.0);
    return result;
  }

 private:
  // Progress after reading the scans, after the first pairs, and before the last pairs.
  static constexpr double kReadProgress = 0.2;
  static constexpr double kFirstPairsProgress = 0.22;
  static constexpr double kLastPairsProgress = 0.98;

  std::vector<ScanPairs> pairs(double reach, const Run& run) const {
    std::vector<ScanPairs> all;
    for (std::size_t s = 0; s < scans_.size(); ++s) {
      for (std::size_t o = 0; o < scans_.size(); ++o) {
        if (s != o) all.push_back({s, o, {}});
      }
    }
    parallel_for(static_cast<std::int64_t>(all.size()), run, [&](std::int64_t i) {
      ScanPairs& scan_pairs = all[static_cast<std::size_t>(i)];
      scan_pairs.pairs = find_pairs(scans_[scan_pairs.scan], samples_[scan_pairs.scan],
                                    scans_[scan_pairs.other], reach);
    });
    return all;
  }

  // Moves all scans; returns a bound on the largest displacement of a point.
  double step(const std::vector<ScanPairs>& all) {
    const double cutoff = cutoff_for(median_distance(all), kMinMotion * spacing_);
    MotionSystem system(scans_.size());
    for (const ScanPairs& scan_pairs : all)
      system.add(scan_pairs.scan, scan_pairs.other, scan_pairs.pairs, cutoff);
    const std::vector<MotionStep> steps = system.solve();
    double farthest = 0.0;
    for (std::size_t s = 1; s < scans_.size(); ++s) {
      MovedScan& scan = scans_[s];
      if (scan.is_empty()) continue;
      farthest = std::max(farthest, scan.move(steps[s]));
    }
    return farthest;
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
  check_alignment(scans, options, 2);
  return Aligner(scans, options).align(options.iterations, options.run);
}

}  // namespace prefilter
