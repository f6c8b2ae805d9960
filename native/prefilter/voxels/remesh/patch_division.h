// SPDX-License-Identifier: GPL-3.0-or-later

// A mesh divided into patches of neighboring triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

struct PatchDivision {
  static constexpr std::size_t kTriangles = 1U << 14;  // of a patch
  static constexpr std::int32_t kUnowned = -1;
  static constexpr std::int32_t kShared = -2;

  std::vector<std::uint32_t> order;  // of triangles: those of a patch are together
  std::vector<std::int32_t> owners;  // of vertices: the patch with all of its triangles, or these

  std::size_t count() const { return (order.size() + kTriangles - 1) / kTriangles; }
  std::span<const std::uint32_t> triangles(std::size_t patch) const {
    const std::size_t begin = patch * kTriangles;
    return std::span(order).subspan(begin, std::min(kTriangles, order.size() - begin));
  }
};

/// Patches follow the Morton curve through cells that lie elsewhere for each `number`. Throws
/// Error(kCancelled).
PatchDivision divide_into_patches(std::span<const Vector3> positions,
                                  std::span<const std::array<std::int32_t, 3>> triangles,
                                  int number, const Progress& progress, int threads);

}  // namespace prefilter
