// SPDX-License-Identifier: GPL-3.0-or-later

// Rounds edges that a contour could not place.
#pragma once

#include <functional>

#include "prefilter/base/progress.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// Smooths vertices of kind kSurface around which a mesh turns by more than about 30 degrees: an
/// edge without vertices of its own comes out as stairs. Those beside vertices of edges stay. Where
/// `is_free(position)`, as no source tells how the surface is, all of them are smoothed, and those
/// beside them too; for `only_free` nothing else. None moves by more than half of `cell` along an
/// axis, or so that triangles would fold or meet. By Taubin, "A signal processing approach to fair
/// surface design" (1995), which all but keeps volume. Throws Error(kCancelled).
void smooth_stairs(double cell, const std::function<bool(const Vector3&)>& is_free, bool only_free,
                   const Progress& progress, int threads, FacetedMesh* mesh);

}  // namespace prefilter
