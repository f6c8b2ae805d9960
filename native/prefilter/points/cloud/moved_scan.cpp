// SPDX-License-Identifier: GPL-3.0-or-later

// Scans in coordinates relative to a common origin, which keeps rounding errors small.
#include "prefilter/points/cloud/moved_scan.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"

namespace prefilter {
namespace {

constexpr std::size_t kSpacingSamples = 1000;
constexpr std::size_t kSpacingNeighbors = 5;  // a point and its four neighbors
constexpr double kMaxScanCoordinate = 1e150;
constexpr int kMaxIterations = 1000;

bool is_usable(const Vector3& vector) {
  return std::abs(vector[0]) <= kMaxScanCoordinate && std::abs(vector[1]) <= kMaxScanCoordinate &&
         std::abs(vector[2]) <= kMaxScanCoordinate;
}

// The valid points of a scan, and their unit normals.
std::pair<std::vector<Vector3>, std::vector<Vector3>> usable_points(const ScanView& scan,
                                                                    const Vector3& origin) {
  std::pair<std::vector<Vector3>, std::vector<Vector3>> valid;
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    const double size = length(scan.normals[i]);
    if (!is_usable(scan.positions[i]) || !is_usable(scan.normals[i]) || !(size > 0.0)) continue;
    valid.first.push_back(scan.positions[i] - origin);
    valid.second.push_back(1.0 / size * scan.normals[i]);
  }
  return valid;
}

}  // namespace

RigidMotion small_motion(const Vector3& turn, const Vector3& shift, const Vector3& center) {
  // The normalized quaternion (1, turn / 2).
  const double x = 0.5 * turn[0];
  const double y = 0.5 * turn[1];
  const double z = 0.5 * turn[2];
  const double scale = 1.0 / (1.0 + x * x + y * y + z * z);
  RigidMotion result;
  result.rows = {Vector3{scale * (1.0 + x * x - y * y - z * z), scale * 2.0 * (x * y - z),
                         scale * 2.0 * (x * z + y)},
                 Vector3{scale * 2.0 * (x * y + z), scale * (1.0 - x * x + y * y - z * z),
                         scale * 2.0 * (y * z - x)},
                 Vector3{scale * 2.0 * (x * z - y), scale * 2.0 * (y * z + x),
                         scale * (1.0 - x * x - y * y + z * z)}};
  result.shift = center + shift - turned(result, center);
  return result;
}

RigidMotion relative_to(const RigidMotion& motion, const Vector3& origin) {
  RigidMotion result = motion;
  result.shift = motion.shift + (turned(motion, origin) - origin);
  return result;
}

Box box_of(std::span<const ScanView> scans) {
  Box box = kEmptyBox;
  for (const ScanView& scan : scans) {
    for (const Vector3& point : scan.positions) {
      if (is_usable(point)) box.include(point);
    }
  }
  return box.low[0] <= box.high[0] ? box : Box{};
}

Vector3 middle_of(const Box& box) {
  return {box.low[0] + 0.5 * box.size(0), box.low[1] + 0.5 * box.size(1),
          box.low[2] + 0.5 * box.size(2)};
}

void check_alignment(std::span<const ScanView> scans, const AlignOptions& options,
                     std::size_t least) {
  if (scans.size() < least) {
    throw_invalid("scans: found " + std::to_string(scans.size()) + "; " +
                  (least == 1 ? "one is needed" : "two are needed"));
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
  if (options.iterations < 1 || options.iterations > kMaxIterations) {
    throw_invalid("iterations: found " + std::to_string(options.iterations) +
                  "; a number from 1 to " + std::to_string(kMaxIterations) + " is needed");
  }
}

MovedScan::MovedScan(const ScanView& scan, const Vector3& origin, const Run& run)
    : MovedScan(usable_points(scan, origin), run) {}

MovedScan::MovedScan(std::pair<std::vector<Vector3>, std::vector<Vector3>> points, const Run& run)
    : search_(points.first, run), normals_(search_.positions().size()) {
  for (std::size_t i = points.first.size(); i-- > 0;) {
    const std::uint32_t place = search_.places()[i];
    if (place != NeighborSearch::kNowhere) normals_[place] = points.second[i];
  }
  if (is_empty()) return;
  for (const Vector3& position : search_.positions()) center_ = center_ + position;
  center_ = 1.0 / static_cast<double>(normals_.size()) * center_;
  std::vector<double> distances;
  Neighbors near;
  for (const std::uint32_t place : samples(kSpacingSamples)) {
    search_.find(place, kSpacingNeighbors, &near);
    distances.push_back(std::sqrt(near.squares().back()));
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  spacing_ = *middle;
}

double MovedScan::move(const MotionStep& step) {
  const Vector3 turn = {step[0], step[1], step[2]};
  const Vector3 shift = {step[3], step[4], step[5]};
  motion = then(motion, small_motion(turn, shift, moved(motion, center_)));
  const Box box = search_.box();
  return length(shift) + length(turn) * length(box.high - box.low);
}

std::vector<std::uint32_t> MovedScan::samples(std::size_t count) const {
  const std::size_t all = normals_.size();
  std::vector<std::uint32_t> places;
  for (std::size_t k = 0; k < std::min(count, all); ++k) {
    places.push_back(static_cast<std::uint32_t>(all <= count ? k : k * all / count));
  }
  return places;
}

}  // namespace prefilter
