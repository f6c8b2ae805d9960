// From triangles to Haar coefficients (section 3.2.3).
#pragma once

#include <cstdint>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/wavelet/haar.h"

namespace prefilter {

/// Triangles in coordinates in which the root is the unit cube.
using RootTriangles = MeshView<std::int32_t>;

/// The Haar coefficients of the shape that the triangles bound, down to cells of `depth` (1 to
/// kMaxTreeDepth). What lies outside of the root does not count. The surface need not be closed: a
/// missing triangle of area A (the root's side being 1) changes the mean of a cell by at most
/// 2.03 A / s^2 for each of the cells of side s that hold both, and that of the root by what
/// `root_mean` leaves. Preconditions: finite positions within 1e6 of the root, valid indices.
/// Throws Error(kCancelled), and std::bad_alloc.
HaarTree analyse_triangles(const RootTriangles& mesh, int depth, const Progress& progress,
                           int threads);

}  // namespace prefilter
