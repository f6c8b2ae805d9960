// SPDX-License-Identifier: GPL-3.0-or-later

// Detects points that form a height field over x and y: a terrain, a table or a relief.
#pragma once

#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Whether z is a function of x and y for most points, so that cells of x and y contain neither two
/// sheets above each other nor walls. Up to three tenths of the points may be in other cells, such
/// as trees and houses in a landscape. False for fewer than 100 points; points that are not finite
/// are ignored. Up to a million points, the result is the same, up to rounding, for any order of
/// the points; larger clouds are sampled. Throws Error(kCancelled).
bool is_height_field(std::span<const Vector3> points, const Run& run);

}  // namespace prefilter
