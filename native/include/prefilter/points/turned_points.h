// SPDX-License-Identifier: GPL-3.0-or-later

// Points whose normals are turned while they are read.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// The points of a source, with each normal that points away from where it should reversed. Zero
/// normals stay.
class TurnedPoints final : public ChangedPoints {
 public:
  enum class Side {
    kUp,         // along z
    kViewpoint,  // to where the scanner stood
  };

  /// `viewpoints`: one for all points or one for each; none: as the source says, or else the
  /// origin. Throws Error for a source without normals, another number of viewpoints where the
  /// source knows how many points it has, or one that is not finite.
  TurnedPoints(PointSource* source, Side side, std::vector<Vector3> viewpoints);

  bool are_normals_directed() const override { return true; }
  /// Viewpoints of points are in the order of these.
  std::optional<std::size_t> rows() const override {
    return viewpoints_.size() > 1 ? std::nullopt : source_->rows();
  }
  void rewind() override;
  bool read(std::size_t most, PointBatch* batch) override;

 private:
  // Of point `i` of a batch, where its normal should point to.
  Vector3 way(const PointBatch& batch, std::size_t i) const;

  Side side_;
  std::vector<Vector3> viewpoints_;
  std::size_t next_ = 0;
};

}  // namespace prefilter
