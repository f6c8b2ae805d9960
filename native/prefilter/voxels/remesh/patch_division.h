// SPDX-License-Identifier: GPL-3.0-or-later

// Divides a mesh into patches of neighboring triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

struct PatchDivision {
  static constexpr std::size_t kTriangles = 1U << 14;  // per patch
  static constexpr std::int32_t kUnowned = -1;
  static constexpr std::int32_t kShared = -2;

  std::vector<std::uint32_t> order;  // triangles, grouped by patch
  // per vertex: the patch with all of its triangles, kUnowned or kShared
  std::vector<std::int32_t> owners;

  std::size_t count() const { return (order.size() + kTriangles - 1) / kTriangles; }
  std::span<const std::uint32_t> triangles(std::size_t patch) const {
    const std::size_t begin = patch * kTriangles;
    return std::span(order).subspan(begin, std::min(kTriangles, order.size() - begin));
  }
};

/// Divides triangles along the Morton curve through a grid of cells that is shifted differently for
/// each `number`. Throws Error(kCancelled).
PatchDivision divide_into_patches(std::span<const Vector3> positions,
                                  std::span<const std::array<std::int32_t, 3>> triangles,
                                  int number, const Run& run);

}  // namespace prefilter
