// SPDX-License-Identifier: GPL-3.0-or-later

// Few triangles for many small ones.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// A triangle that another one stands for, or parts of it.
struct Represented {
  std::uint32_t triangle;
  std::uint32_t representative;
  double area;
  bool is_back;  // the other face of a sheet: what is thin of one is thin of both
};

/// Whole triangles, and then pieces of narrow ones.
struct Representatives {
  std::vector<std::uint32_t> triangles;
  std::vector<std::array<Vector3, 3>> pieces;
  std::vector<double> shares;       // of each: the area that it stands for, its own being 1
  std::vector<bool> are_sheets;     // with another one as their back
  std::vector<Represented> others;  // of a triangle and a representative, no more than one

  std::array<Vector3, 3> corners(const MeshView<std::int32_t>& mesh, std::size_t i) const {
    const std::size_t whole = triangles.size() - pieces.size();
    return i < whole ? mesh.corners(triangles[i]) : pieces[i - whole];
  }
};

/// Of these triangles. What is smaller than a quarter of a cell has the first one that is in the
/// same cube of that side and faces about the same way, so that there are no more than cells can
/// tell apart, however fine a mesh is. So have the pieces of what is longer and as narrow, of those
/// that run about the same way; pieces are no longer than a cell, and `is_needed(corners)` says
/// which parts have any. What is larger stands for those on the same corners where some of these
/// face the other way. Lengths are cells.
Representatives find_representatives(
    const MeshView<std::int32_t>& mesh, std::span<const Vector3> normals,
    std::span<const std::uint32_t> triangles,
    const std::function<bool(const std::array<Vector3, 3>&)>& is_needed);

}  // namespace prefilter
