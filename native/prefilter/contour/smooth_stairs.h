// SPDX-License-Identifier: GPL-3.0-or-later

// Rounds edges that a contour could not place.
#pragma once

#include <functional>

#include "prefilter/base/progress.h"
#include "prefilter/remesh/faceted_mesh.h"

namespace prefilter {

/// Smooths what turns by more than about 30 degrees around a vertex of kind kSurface, and the
/// vertices beside it: an edge without vertices of its own comes out as stairs. Only vertices move
/// that `may_move(position)`, by at most half of `cell`, and none by which triangles would fold or
/// meet. By Taubin, "A signal processing approach to fair surface design" (1995), which keeps
/// volume. Throws Error(kCancelled).
void smooth_stairs(double cell, const std::function<bool(const Vector3&)>& may_move,
                   const Progress& progress, int threads, FacetedMesh* mesh);

}  // namespace prefilter
