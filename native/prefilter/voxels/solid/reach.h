// SPDX-License-Identifier: GPL-3.0-or-later

// Labels the cells that the outside can reach.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Labels the cells of a grid around a mesh: surface, outside, or a region that the outside does
/// not reach through gaps of up to some width.
class ReachGrid {
 public:
  using Label = std::uint16_t;
  static constexpr Label kSurface = 0;  // a triangle crosses the cell
  static constexpr Label kOutside = 1;
  static constexpr Label kPocket = 2;  // too narrow to belong to either
  static constexpr Label kFirstRegion = 3;

  /// Cells have side `cell`, or larger where there would be more than 256 along an axis; `gap` is a
  /// length. Throws Error(kCancelled).
  ReachGrid(const MeshView<std::int32_t>& mesh, double cell, double gap, const Run& run);

  double cell() const { return cell_; }
  const Vector3& origin() const { return origin_; }
  const std::array<int, 3>& size() const { return size_; }
  const std::vector<Label>& labels() const { return labels_; }
  /// End of the labels of regions, which start at kFirstRegion.
  Label region_end() const { return region_end_; }

  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(x) * static_cast<std::size_t>(size_[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size_[2]) +
           static_cast<std::size_t>(z);
  }
  /// Label of the cell that contains a point; kOutside beyond the grid.
  Label at(const Vector3& point) const;
  /// Label of the first cell that is not surface on the ray from a point along a unit direction;
  /// kSurface if there is none within kMaxRayCells cells.
  Label first_beyond_surface(const Vector3& point, const Vector3& direction) const;

 private:
  static constexpr double kMaxRayCells = 4.0;
  static constexpr Label kUnset = 0xFFFF;

  void mark_surface(const MeshView<std::int32_t>& mesh, const Run& run);
  // Labels the connected component of free cells around `seed`, and marks them as no longer free.
  void flood(std::size_t seed, Label label, std::vector<std::uint8_t>* is_free);
  void grow(int steps);
  template <typename Visit>
  void for_neighbors(std::size_t cell, const Visit& visit) const;

  double cell_;
  Vector3 origin_{};
  std::array<int, 3> size_{};
  std::vector<Label> labels_;
  Label region_end_ = kFirstRegion;
  std::vector<std::size_t> stack_;
};

}  // namespace prefilter
