// SPDX-License-Identifier: GPL-3.0-or-later

// Points of a source at another place.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/rigid_motion.h"
#include "prefilter/scan/point_source.h"

namespace prefilter {

/// The points of a source after a motion, with their normals and viewpoints; the source must
/// outlive it.
class MovedPoints final : public PointSource {
 public:
  MovedPoints(PointSource* source, const RigidMotion& motion) : source_(source), motion_(motion) {}

  std::optional<std::size_t> count() const override { return source_->count(); }
  bool has_normals() const override { return source_->has_normals(); }
  bool are_normals_directed() const override { return source_->are_normals_directed(); }
  const std::vector<PointAttribute>& attributes() const override { return source_->attributes(); }
  std::optional<Vector3> viewpoint() const override {
    const std::optional<Vector3> viewpoint = source_->viewpoint();
    return viewpoint ? std::optional(moved(motion_, *viewpoint)) : std::nullopt;
  }
  bool is_double() const override { return source_->is_double(); }
  void rewind() override { source_->rewind(); }

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
  PointSource* source_;
  RigidMotion motion_;
};

}  // namespace prefilter
