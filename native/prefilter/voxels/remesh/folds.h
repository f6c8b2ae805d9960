// SPDX-License-Identifier: GPL-3.0-or-later

// Where a mesh is folded.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// The cosine between normals of two triangles at an edge that is a fold: 120 degrees.
inline constexpr double kFold = -0.5;

/// The pairs of triangles with such an edge, of all from `first` on, with one suspect at least;
/// without flags all are. Throws Error(kCancelled).
std::vector<std::array<std::uint32_t, 2>> folded_pairs(const MeshView<std::int32_t>& mesh,
                                                       std::size_t first,
                                                       std::span<const std::uint8_t> is_suspect,
                                                       const Progress& progress);

}  // namespace prefilter
