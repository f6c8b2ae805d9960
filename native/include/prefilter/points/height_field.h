// SPDX-License-Identifier: GPL-3.0-or-later

// Whether points are the heights of a terrain, a table or a relief, above x and y.
#pragma once

#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// Whether z is a function of x and y on the surface that points were taken from, for most of them:
/// so it is where there are no two sheets one above the other, nor walls, in cells of x and y that
/// hold some points. Up to three tenths of the points may be in others, as trees and houses are in
/// a landscape. False for fewer than 100 points; those that are not finite do not count. The same
/// to rounding for any order of up to a million points; of more, some are looked at. Throws
/// Error(kCancelled).
bool is_height_field(std::span<const Vector3> points, const Progress& progress);

}  // namespace prefilter
