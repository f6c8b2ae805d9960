// SPDX-License-Identifier: GPL-3.0-or-later

// Fast path for convex contours that are disjoint or nested, whose overlaps need no arrangement.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "prefilter/base/outline.h"

namespace prefilter {

/// What resolving does to a contour that meets no other.
enum class ContourUse : std::uint8_t { kKept, kReversed, kDropped };

/// The use of every contour, if all are convex with few points, and any two have disjoint interiors
/// or one contains the other; they may touch. Nothing if this does not hold or takes too long to
/// show.
std::optional<std::vector<ContourUse>> convex_contour_uses(const Outline& outline, FillRule rule);

}  // namespace prefilter
