// SPDX-License-Identifier: GPL-3.0-or-later

// Points whose normals are turned while they are read.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/scan/point_source.h"

namespace prefilter {

/// The points of a source, which must outlive it, with each normal that points away from where it
/// should reversed. Zero normals stay.
class TurnedPoints final : public PointSource {
 public:
  enum class Side {
    kUp,         // along z
    kViewpoint,  // to where the scanner stood
  };

  /// `viewpoints`: one for all points or one for each; none: as the source says, or else the
  /// origin. Throws Error for a source without normals, another number of viewpoints where the
  /// source knows how many points it has, or one that is not finite.
  TurnedPoints(PointSource* source, Side side, std::vector<Vector3> viewpoints);

  std::optional<std::size_t> count() const override { return source_->count(); }
  bool has_normals() const override { return true; }
  const std::vector<PointAttribute>& attributes() const override { return source_->attributes(); }
  std::optional<Vector3> viewpoint() const override { return source_->viewpoint(); }
  bool is_double() const override { return source_->is_double(); }
  void rewind() override;
  bool read(std::size_t most, PointBatch* batch) override;

 private:
  // Of point `i` of a batch, where its normal should point to.
  Vector3 way(const PointBatch& batch, std::size_t i) const;

  PointSource* source_;
  Side side_;
  std::vector<Vector3> viewpoints_;
  std::size_t next_ = 0;
};

}  // namespace prefilter
