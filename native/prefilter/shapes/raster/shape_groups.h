// SPDX-License-Identifier: GPL-3.0-or-later

// Shapes that are apart from each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/outline.h"

namespace prefilter {

/// Numbers of boxes in rising order, by groups: boxes of different groups do not meet. They are
/// found by a sweep that joins what meets to one interval, so that there may be fewer groups than
/// there could be. Empty boxes are in none.
std::vector<std::vector<std::uint32_t>> groups_apart(std::span<const Box2> boxes);

}  // namespace prefilter
