// SPDX-License-Identifier: GPL-3.0-or-later

// Reverses normals that point away from their target.
#include "prefilter/points/turned_points.h"

#include <string>
#include <utility>

#include "prefilter/base/error.h"

namespace prefilter {

TurnedPoints::TurnedPoints(PointSource* source, Side side, std::vector<Vector3> viewpoints)
    : ChangedPoints(source), side_(side), viewpoints_(std::move(viewpoints)) {
  if (!source->has_normals()) throw_invalid("source: has no normals; they are needed");
  const std::optional<std::size_t> points = source->count();
  if (viewpoints_.size() > 1 && points && viewpoints_.size() != *points) {
    throw_invalid("viewpoint: found " + std::to_string(viewpoints_.size()) + " for " +
                  std::to_string(*points) + " points; one for all or one for each is needed");
  }
  check_points(std::span<const Vector3>(viewpoints_), "viewpoint: row", kLargestCoordinate);
}

void TurnedPoints::rewind() {
  source_->rewind();
  next_ = 0;
}

Vector3 TurnedPoints::target_direction(const PointBatch& batch, std::size_t i) const {
  if (side_ == Side::kUp) return {0.0, 0.0, 1.0};
  if (viewpoints_.size() == 1) return viewpoints_.front() - batch.positions[i];
  if (!viewpoints_.empty()) return viewpoints_.at(next_ + i) - batch.positions[i];
  if (!batch.viewpoints.empty()) return batch.viewpoints[i] - batch.positions[i];
  return source_->viewpoint().value_or(Vector3{}) - batch.positions[i];
}

bool TurnedPoints::read(std::size_t most, PointBatch* batch) {
  if (!source_->read(most, batch)) return false;
  for (std::size_t i = 0; i < batch->normals.size(); ++i) {
    auto& normal = batch->normals[i];
    const Vector3 wide = {static_cast<double>(normal[0]), static_cast<double>(normal[1]),
                          static_cast<double>(normal[2])};
    if (!(dot(wide, target_direction(*batch, i)) < 0.0)) continue;
    for (float& x : normal) x = -x;
  }
  next_ += batch->positions.size();
  return true;
}

}  // namespace prefilter
