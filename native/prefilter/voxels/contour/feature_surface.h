// SPDX-License-Identifier: GPL-3.0-or-later

// The surface on which a contour's edges and corners are placed.
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
  std::int32_t triangle;  // -1 if the surface has no triangles
  std::int32_t label;     // of its region
};

/// A corner that is known in advance.
struct FeatureCorner {
  Vector3 position;
  std::span<const std::int32_t> labels;  // of the regions around it, sorted
};

/// A surface of smooth regions that meet at edges and corners. Lengths are in the frame's unit;
/// search results do not depend on the number of threads.
class FeatureSurface {
 public:
  FeatureSurface() = default;
  FeatureSurface(const FeatureSurface&) = delete;
  FeatureSurface& operator=(const FeatureSurface&) = delete;
  virtual ~FeatureSurface() = default;

  /// Side of the finest cells.
  virtual double cell() const = 0;

  /// The nearest point within `reach`, on one region unless `label` is -1.
  virtual std::optional<SourcePoint> nearest(const Vector3& point, double reach,
                                             std::int32_t label) const = 0;

  /// The nearest point within `reach` on the borders between two regions; two equal labels select
  /// sharp edges within a region. None if borders are unknown.
  virtual std::optional<Vector3> nearest_border(const Vector3& point, double reach,
                                                std::int32_t label, std::int32_t other) const = 0;

  virtual std::size_t corner_count() const = 0;
  virtual FeatureCorner corner(std::size_t index) const = 0;
};

}  // namespace prefilter
