// SPDX-License-Identifier: GPL-3.0-or-later

// Unions, intersections and differences of filled outlines.
#pragma once

#include <cstdint>

#include "prefilter/base/names.h"
#include "prefilter/base/outline.h"
#include "prefilter/shapes/resolve.h"

namespace prefilter {

enum class OutlineOperation : std::uint8_t { kUnion, kIntersection, kDifference };

inline constexpr Named<OutlineOperation> kOutlineOperations[] = {
    {"union", OutlineOperation::kUnion},
    {"intersection", OutlineOperation::kIntersection},
    {"difference", OutlineOperation::kDifference}};

/// The boundary of a set operation on the regions that two outlines fill, in the form of `resolve`.
/// Throws Error for points that are not finite, or above 1e100 in magnitude.
Outline combine(const Outline& first, FillRule first_rule, const Outline& second,
                FillRule second_rule, OutlineOperation operation,
                double tolerance = kOutlineTolerance);

}  // namespace prefilter
