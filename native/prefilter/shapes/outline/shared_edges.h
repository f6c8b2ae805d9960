// SPDX-License-Identifier: GPL-3.0-or-later

// Outlines side by side, as on a map: edges that two of them share cancel.
#pragma once

#include <span>

#include "prefilter/base/outline.h"

namespace prefilter {

/// Whether outlines, of which each winds once around what it fills, are beside each other: no point
/// is in two of them. Is told where at least a quarter of their segments are shared, each the other
/// way round in its neighbor; else, and where that takes more steps than some for every curve, it
/// is false.
bool are_side_by_side(std::span<const Outline* const> outlines);

}  // namespace prefilter
