// SPDX-License-Identifier: GPL-3.0-or-later

// A scan with its current motion, and a search structure.
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

/// A rigid motion by a rotation vector in radians about a center, and a shift. Agrees with the
/// rotation to second order.
RigidMotion small_motion(const Vector3& turn, const Vector3& shift, const Vector3& center);

/// The same motion for points relative to an origin.
RigidMotion relative_to(const RigidMotion& motion, const Vector3& origin);

/// Throws Error for fewer scans than `least`, and for arguments that align_scans rejects.
void check_alignment(std::span<const ScanView> scans, const AlignOptions& options,
                     std::size_t least);

/// Bounding box of the valid points; at 0 if there are none.
Box box_of(std::span<const ScanView> scans);
Vector3 middle_of(const Box& box);

inline constexpr double kMinMotion = 1e-4;          // a smaller motion counts as none, in spacings
inline constexpr double kMinReach = 4.0;            // in spacings
inline constexpr std::size_t kMaxSamples = 20'000;  // per scan

/// The points of a scan that have a normal, relative to an origin.
class MovedScan {
 public:
  MovedScan(const ScanView& scan, const Vector3& origin, const Run& run);

  const NeighborSearch& search() const { return search_; }
  const Vector3& position(std::uint32_t place) const { return search_.positions()[place]; }
  const Vector3& normal(std::uint32_t place) const { return normals_[place]; }
  /// Typical distance between points: the median over a sample.
  double spacing() const { return spacing_; }
  /// Mean of the positions.
  const Vector3& center() const { return center_; }
  bool is_empty() const { return normals_.empty(); }

  /// At most `count` indices, evenly spaced along the search curve.
  std::vector<std::uint32_t> samples(std::size_t count) const;

  /// Applies a rotation about the current center, then a translation. Returns a bound on the
  /// largest displacement of a point.
  double move(const MotionStep& step);

  RigidMotion motion;

 private:
  // Positions and unit normals.
  MovedScan(std::pair<std::vector<Vector3>, std::vector<Vector3>> points, const Run& run);

  NeighborSearch search_;
  std::vector<Vector3> normals_;  // by index, of length 1
  double spacing_ = 0.0;
  Vector3 center_{};
};

}  // namespace prefilter
