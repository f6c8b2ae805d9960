// SPDX-License-Identifier: GPL-3.0-or-later

// Applies a rigid motion to the points of a source.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/rigid_motion.h"
#include "prefilter/points/point_source.h"

namespace prefilter {

/// The points, normals and viewpoints of a source after a rigid motion.
class MovedPoints final : public ChangedPoints {
 public:
  MovedPoints(PointSource* source, const RigidMotion& motion)
      : ChangedPoints(source), motion_(motion) {}

  std::optional<Vector3> viewpoint() const override {
    const std::optional<Vector3> viewpoint = source_->viewpoint();
    return viewpoint ? std::optional(moved(motion_, *viewpoint)) : std::nullopt;
  }

  bool read(std::size_t most, PointBatch* batch) override {
    if (!source_->read(most, batch)) return false;
    for (Vector3& position : batch->positions) position = moved(motion_, position);
    for (Vector3& viewpoint : batch->viewpoints) viewpoint = moved(motion_, viewpoint);
    for (std::array<float, 3>& normal : batch->normals) {
      const Vector3 to = turned(motion_, {normal[0], normal[1], normal[2]});
      normal = {static_cast<float>(to[0]), static_cast<float>(to[1]), static_cast<float>(to[2])};
    }
    return true;
  }

 private:
  RigidMotion motion_;
};

}  // namespace prefilter
