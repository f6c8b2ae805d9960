// SPDX-License-Identifier: GPL-3.0-or-later

// Finds the folds of a mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Cosine between the normals of adjacent triangles below which their edge is a fold: 120 degrees.
inline constexpr double kFold = -0.5;

/// Pairs of adjacent triangles that are folded, among triangles from `first` on, with at least one
/// suspect; if there are no flags, all are suspect. Throws Error(kCancelled).
std::vector<std::array<std::uint32_t, 2>> folded_pairs(const MeshView<std::int32_t>& mesh,
                                                       std::size_t first,
                                                       std::span<const std::uint8_t> is_suspect,
                                                       const Run& run);

}  // namespace prefilter
