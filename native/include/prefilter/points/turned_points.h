// SPDX-License-Identifier: GPL-3.0-or-later

// Orients the normals of a source while it is read.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// The points of a source, with normals reversed if they point away from their target. Zero normals
/// stay zero.
class TurnedPoints final : public ChangedPoints {
 public:
  enum class Side {
    kUp,         // toward +z
    kViewpoint,  // toward the scanner's position
  };

  /// `viewpoints`: one for all points or one for each; if empty, the source's viewpoints, or else
  /// the origin. Throws Error for a source without normals, a number of viewpoints that does not
  /// match a known number of points, or a viewpoint that is not finite.
  TurnedPoints(PointSource* source, Side side, std::vector<Vector3> viewpoints);

  bool are_normals_directed() const override { return true; }
  /// None with a viewpoint per point, as these follow the order of reading.
  std::optional<std::size_t> rows() const override {
    return viewpoints_.size() > 1 ? std::nullopt : source_->rows();
  }
  void rewind() override;
  bool read(std::size_t most, PointBatch* batch) override;

 private:
  // Direction that the normal of point `i` of a batch should have.
  Vector3 target_direction(const PointBatch& batch, std::size_t i) const;

  Side side_;
  std::vector<Vector3> viewpoints_;
  std::size_t next_ = 0;
};

}  // namespace prefilter
