// SPDX-License-Identifier: GPL-3.0-or-later

// Smooths edges that a contour could not place.
#pragma once

#include <functional>

#include "prefilter/base/run.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// Smooths vertices of kind kSurface around which a mesh turns by more than about 30 degrees: an
/// edge without vertices of its own looks like stairs. Their neighbors on edges stay. Where
/// `is_free(position)`, because no source defines the surface, all vertices are smoothed, including
/// neighbors of edges; with `only_free`, only these are. No vertex moves by more than half of
/// `cell` along an axis, or so that triangles would fold or intersect. Follows G. Taubin, A signal
/// processing approach to fair surface design (1995), which nearly preserves volume. Throws
/// Error(kCancelled).
void smooth_stairs(double cell, const std::function<bool(const Vector3&)>& is_free, bool only_free,
                   const Run& run, FacetedMesh* mesh);

}  // namespace prefilter
