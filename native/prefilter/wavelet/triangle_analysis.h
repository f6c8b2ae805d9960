// SPDX-License-Identifier: GPL-3.0-or-later

// From triangles to Haar coefficients (section 3.2.3).
#pragma once

#include <cstdint>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/wavelet/haar.h"

namespace prefilter {

/// Triangles in coordinates in which the root is the unit cube, carried there as they are read.
struct RootTriangles {
  InputMesh mesh;
  Box root = {{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};  // in the mesh's own coordinates

  std::array<Vector3, 3> corners(std::size_t triangle) const {
    std::array<Vector3, 3> corners = mesh.corners(triangle);
    for (Vector3& p : corners) {
      for (int a = 0; a < 3; ++a) p[a] = (p[a] - root.low[a]) / root.size(a);
    }
    return corners;
  }
};

/// The Haar coefficients of the shape that the triangles bound, down to cells of `depth` (1 to
/// kMaxTreeDepth). What lies outside of the root does not count. The surface need not be closed: a
/// missing triangle of area A (the root's side being 1) changes the mean of a cell by at most
/// 2.03 A / s^2 for each of the cells of side s that hold both, and that of the root by what
/// `root_mean` leaves. Preconditions: finite positions within 1e6 of the root, valid indices.
/// Throws Error(kCancelled), and std::bad_alloc.
HaarTree analyze_triangles(const RootTriangles& mesh, int depth, const Progress& progress,
                           int threads);

}  // namespace prefilter
