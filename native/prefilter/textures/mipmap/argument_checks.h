// SPDX-License-Identifier: GPL-3.0-or-later

// Argument checks shared by the entry functions of this folder.
#pragma once

#include <vector>

#include "prefilter/base/value_range.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/geometry/texels/texel_triangles.h"
#include "prefilter/textures/mipmaps.h"

namespace prefilter {

/// Converts bounds to a range. Throws Error if one is NaN or the low one is above the high one.
ValueRange range_of(const Bounds& bounds);

/// Throws Error unless the surfaces have a positive, finite total area.
void check_surface_area(const std::vector<const Surface*>& surfaces);

/// Throws Error unless some of the surface lies inside the image.
void check_mapped(const TexelTriangles& triangles);

/// Throws the Error for surfaces entirely outside the image.
[[noreturn]] void throw_outside();

}  // namespace prefilter
