// SPDX-License-Identifier: GPL-3.0-or-later

// Unions, intersections and differences of what outlines fill.
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

/// The boundary of a set operation of what two outlines fill by their rules, as `resolve` would
/// have it. Throws Error where a point is not finite, or farther than 1e100 away.
Outline combine(const Outline& first, FillRule first_rule, const Outline& second,
                FillRule second_rule, OutlineOperation operation,
                double tolerance = kOutlineTolerance);

}  // namespace prefilter
