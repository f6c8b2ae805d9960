// SPDX-License-Identifier: GPL-3.0-or-later

// Shapes that tile the plane like a map: edges that two of them share cancel.
#pragma once

#include <span>

#include "prefilter/base/outline.h"

namespace prefilter {

/// Whether no point is inside two of the outlines, each of which must wind once around its filled
/// part. Tested only if at least a quarter of the segments are shared by two outlines, in opposite
/// directions; false otherwise, and if the test exceeds a constant number of steps per curve.
bool have_disjoint_interiors(std::span<const Outline* const> outlines);

}  // namespace prefilter
