// SPDX-License-Identifier: GPL-3.0-or-later

// A scan on its way to its place, ready for searches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "prefilter/geometry/spatial/nearest_neighbors.h"
#include "prefilter/points/align_scans.h"
#include "prefilter/points/cloud/motion_system.h"

namespace prefilter {

/// A small turn by the lengths of its axis in radians, about a center, and a shift: a motion
/// exactly, which agrees with that turn to the second order.
RigidMotion small_motion(const Vector3& turn, const Vector3& shift, const Vector3& center);

/// The same motion, of points that are told relative to an origin.
RigidMotion about(const RigidMotion& motion, const Vector3& origin);

/// Throws Error for fewer scans than `least`, and what align_scans refuses besides.
void check_alignment(std::span<const ScanView> scans, const AlignOptions& options,
                     std::size_t least);

/// Around the points that are not left out; at 0 for none.
Box box_of(std::span<const ScanView> scans);
Vector3 middle_of(const Box& box);

inline constexpr double kStill = 1e-4;               // a motion so small, in spacings, is none
inline constexpr double kLeastReach = 4.0;           // in spacings
inline constexpr std::size_t kMostSamples = 20'000;  // of a scan

/// The points of a scan that have a normal, relative to an origin.
class MovedScan {
 public:
  MovedScan(const ScanView& scan, const Vector3& origin, const Progress& progress, int threads);

  const NeighborSearch& search() const { return search_; }
  const Vector3& position(std::uint32_t place) const { return search_.positions()[place]; }
  const Vector3& normal(std::uint32_t place) const { return normals_[place]; }
  /// How far apart points are, about: the median over some.
  double spacing() const { return spacing_; }
  /// The mean of the positions.
  const Vector3& center() const { return center_; }
  bool is_empty() const { return normals_.empty(); }

  /// Some places, evenly along the curve: `count` at the most.
  std::vector<std::uint32_t> samples(std::size_t count) const;

  /// Moves it on: a turn about where its center is, then a shift. Returns how far the farthest
  /// point went, about.
  double move(const MotionStep& step);

  RigidMotion motion;

 private:
  // Positions and normals, 1 long.
  MovedScan(std::pair<std::vector<Vector3>, std::vector<Vector3>> points, const Progress& progress,
            int threads);

  NeighborSearch search_;
  std::vector<Vector3> normals_;  // by place, 1 long
  double spacing_ = 0.0;
  Vector3 center_{};
};

}  // namespace prefilter
