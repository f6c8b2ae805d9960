// SPDX-License-Identifier: GPL-3.0-or-later

// Represents many small triangles by few.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// A triangle, or part of it, that another one represents.
struct Represented {
  std::uint32_t triangle;
  std::uint32_t representative;
  double area;
  bool is_back;  // the reverse face of a sheet, which is equally thin
};

/// Representatives: whole triangles, followed by pieces of narrow ones.
struct Representatives {
  std::vector<std::uint32_t> triangles;
  std::vector<std::array<Vector3, 3>> pieces;
  std::vector<double> shares;       // represented area relative to each representative's own
  std::vector<bool> are_sheets;     // whether there is a reverse face
  std::vector<Represented> others;  // at most one entry per triangle and representative

  std::array<Vector3, 3> corners(const MeshView<std::int32_t>& mesh, std::size_t i) const {
    const std::size_t whole = triangles.size() - pieces.size();
    return i < whole ? mesh.corners(triangles[i]) : pieces[i - whole];
  }
};

/// Chooses representatives of the given triangles; lengths are in cells. Triangles smaller than a
/// quarter of a cell are represented by the first one in the same cube of that side with about the
/// same direction, which bounds their number by what cells can distinguish. The same applies to
/// pieces of longer but equally narrow triangles with about the same axis; pieces are at most one
/// cell long, and only made for parts for which `is_needed(corners)` holds. Larger triangles
/// represent others with the same corners if some of these have the opposite orientation.
Representatives find_representatives(
    const MeshView<std::int32_t>& mesh, std::span<const Vector3> normals,
    std::span<const std::uint32_t> triangles,
    const std::function<bool(const std::array<Vector3, 3>&)>& is_needed);

}  // namespace prefilter
