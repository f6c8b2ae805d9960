// SPDX-License-Identifier: GPL-3.0-or-later

// Checks that the entry functions of this room share. Each throws Error.
#pragma once

#include <vector>

#include "prefilter/base/value_range.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/textures/mipmaps.h"
#include "prefilter/textures/texels/texel_triangles.h"

namespace prefilter {

/// Bounds as a range, unless one is no number or the low one is above the high one.
ValueRange range_of(const Bounds& bounds);

/// Unless the surfaces have a positive, finite area in all.
void check_surface_area(const std::vector<const Surface*>& surfaces);

/// Unless some of the surface lies inside of the image.
void check_mapped(const TexelTriangles& triangles);

/// Always: none of the surface lies inside of the image.
[[noreturn]] void throw_outside();

}  // namespace prefilter
