// SPDX-License-Identifier: GPL-3.0-or-later

// Contours whose overlaps are seen at a glance: convex ones, apart from each other or one in
// another.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "prefilter/base/outline.h"

namespace prefilter {

/// What becomes of a contour that meets no other.
enum class ContourUse : std::uint8_t { kKept, kReversed, kDropped };

/// For every contour what `resolve` makes of it, where all are convex, of few points, and each two
/// of them have no inner point in common, or one holds the other; they may touch. Nothing where
/// that is not so, or not seen soon.
std::optional<std::vector<ContourUse>> convex_contour_uses(const Outline& outline, FillRule rule);

}  // namespace prefilter
