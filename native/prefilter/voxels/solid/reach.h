// SPDX-License-Identifier: GPL-3.0-or-later

// What the outside reaches, cell by cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// The cells of a grid around a mesh, by what they belong to: the mesh, the outside, or a region
/// that the outside does not reach through gaps of up to some width.
class ReachGrid {
 public:
  using Label = std::uint16_t;
  static constexpr Label kMet = 0;  // a triangle passes through the cell
  static constexpr Label kOutside = 1;
  static constexpr Label kPocket = 2;  // too narrow to tell
  static constexpr Label kFirstRegion = 3;

  /// Cells are of side `cell`, or larger where there would be more than 256 along an axis; `gap` is
  /// a length. Throws Error(kCancelled).
  ReachGrid(const MeshView<std::int32_t>& mesh, double cell, double gap, const Progress& progress,
            int threads);

  double cell() const { return cell_; }
  const Vector3& origin() const { return origin_; }
  const std::array<int, 3>& size() const { return size_; }
  const std::vector<Label>& labels() const { return labels_; }
  /// Regions have the numbers from kFirstRegion up to this one, without it.
  Label region_end() const { return region_end_; }

  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(x) * static_cast<std::size_t>(size_[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size_[2]) +
           static_cast<std::size_t>(z);
  }
  /// Of the cell that holds a point; the outside beyond the grid.
  Label at(const Vector3& point) const;
  /// The first cell that is none of the mesh's on the way from a point along a direction of length
  /// 1; kMet where there is none within `kFarthest` cells.
  Label along(const Vector3& point, const Vector3& direction) const;

 private:
  static constexpr double kFarthest = 4.0;
  static constexpr Label kUnset = 0xFFFF;

  void mark_met(const MeshView<std::int32_t>& mesh, const Progress& progress, int threads);
  // Of the cells that are free, those that hang together with one; they are so no more.
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
