// SPDX-License-Identifier: GPL-3.0-or-later

// What a contour's edges and corners are placed on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// A point of a surface, with its unit normal.
struct SourcePoint {
  Vector3 position;
  Vector3 normal;
  std::int32_t triangle;  // -1 where the surface has none
  std::int32_t label;     // of its region
};

/// A corner that is known beforehand.
struct FeatureCorner {
  Vector3 position;
  std::span<const std::int32_t> labels;  // of the regions around it, in order
};

/// A surface of smooth regions, which meet at edges and corners. Lengths are the frame's; what
/// searches find is the same for any number of threads.
class FeatureSurface {
 public:
  FeatureSurface() = default;
  FeatureSurface(const FeatureSurface&) = delete;
  FeatureSurface& operator=(const FeatureSurface&) = delete;
  virtual ~FeatureSurface() = default;

  /// The side of the finest cells.
  virtual double cell() const = 0;

  /// The nearest point within `reach`, of one region unless `label` is -1.
  virtual std::optional<SourcePoint> nearest(const Vector3& point, double reach,
                                             std::int32_t label) const = 0;

  /// The nearest point, within `reach`, of the borders between two regions; the same label twice
  /// asks for sharp edges within a region. None where borders are not known.
  virtual std::optional<Vector3> nearest_border(const Vector3& point, double reach,
                                                std::int32_t label, std::int32_t other) const = 0;

  virtual std::size_t corner_count() const = 0;
  virtual FeatureCorner corner(std::size_t index) const = 0;
};

}  // namespace prefilter
