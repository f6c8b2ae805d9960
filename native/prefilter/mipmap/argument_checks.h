// SPDX-License-Identifier: GPL-3.0-or-later

// Checks that the entry functions of this room share. Each throws Error.
#pragma once

#include <vector>

#include "prefilter/surface/surface.h"
#include "prefilter/texels/texel_triangles.h"

namespace prefilter {

/// Unless the surfaces have a positive, finite area in all.
void check_surface_area(const std::vector<const Surface*>& surfaces);

/// Unless some of the surface lies inside of the image.
void check_mapped(const TexelTriangles& triangles);

/// Always: none of the surface lies inside of the image.
[[noreturn]] void throw_outside();

}  // namespace prefilter
