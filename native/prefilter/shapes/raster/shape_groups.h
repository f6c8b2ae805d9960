// SPDX-License-Identifier: GPL-3.0-or-later

// Groups shapes whose boxes overlap.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/outline.h"

namespace prefilter {

/// Indices of boxes by group, in ascending order: boxes of different groups do not overlap. The
/// sweep merges overlapping boxes to one interval, so groups may be larger than necessary. Empty
/// boxes are in no group.
std::vector<std::vector<std::uint32_t>> overlapping_groups(std::span<const Box2> boxes);

}  // namespace prefilter
