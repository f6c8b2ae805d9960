// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/cloud/moved_scan.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace prefilter {
namespace {

constexpr std::size_t kSpacingSamples = 1000;
constexpr std::size_t kNear = 5;  // a point and the four around it
constexpr double kLargest = 1e150;

bool is_usable(const Vector3& vector) {
  return std::abs(vector[0]) <= kLargest && std::abs(vector[1]) <= kLargest &&
         std::abs(vector[2]) <= kLargest;
}

// The points of a scan that count, and their normals, 1 long.
std::pair<std::vector<Vector3>, std::vector<Vector3>> usable(const ScanView& scan,
                                                             const Vector3& origin) {
  std::pair<std::vector<Vector3>, std::vector<Vector3>> found;
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    const double size = length(scan.normals[i]);
    if (!is_usable(scan.positions[i]) || !is_usable(scan.normals[i]) || !(size > 0.0)) continue;
    found.first.push_back(scan.positions[i] - origin);
    found.second.push_back(1.0 / size * scan.normals[i]);
  }
  return found;
}

}  // namespace

RigidMotion small_motion(const Vector3& turn, const Vector3& shift, const Vector3& center) {
  // The quaternion (1, turn / 2), made 1 long.
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

MovedScan::MovedScan(const ScanView& scan, const Vector3& origin, const Progress& progress,
                     int threads)
    : MovedScan(usable(scan, origin), progress, threads) {}

MovedScan::MovedScan(std::pair<std::vector<Vector3>, std::vector<Vector3>> points,
                     const Progress& progress, int threads)
    : search_(points.first, progress, threads), normals_(search_.positions().size()) {
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
    search_.find(place, kNear, &near);
    distances.push_back(std::sqrt(near.squares().back()));
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  spacing_ = *middle;
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
