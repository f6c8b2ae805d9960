// SPDX-License-Identifier: GPL-3.0-or-later

// Where a small part of a mesh that has changed meets the rest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// The pairs of intersecting_triangles, of all from `first` on, with one suspect at least. Only
/// triangles are looked at that are in one cube with a suspect; cubes have this side, and a
/// coordinate at most 2^20 sides. Throws Error(kCancelled).
std::vector<std::array<std::uint32_t, 2>> near_intersections(
    const MeshView<std::int32_t>& mesh, std::size_t first, std::span<const std::uint8_t> is_suspect,
    double side, const Progress& progress, int threads);

}  // namespace prefilter
