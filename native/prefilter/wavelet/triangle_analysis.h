// SPDX-License-Identifier: GPL-3.0-or-later

// Haar coefficients of triangle meshes (section 3.2.3).
#pragma once

#include <cstdint>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/wavelet/haar.h"

namespace prefilter {

/// A mesh in coordinates in which the root is the unit cube; positions are transformed when read.
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

/// The Haar coefficients of the shape bounded by the triangles, down to cells of `depth` (1 to
/// kMaxTreeDepth). Parts outside the root do not count. The surface may have holes: a missing
/// triangle of area A (relative to a root side of 1) changes the mean of a cell by at most 2.03 A /
/// s^2 for each of the cells of side s that contain both, and the mean of the root by the error of
/// `root_mean`. Preconditions: finite positions within 1e6 of the root, valid indices. Throws
/// Error(kCancelled), and std::bad_alloc.
HaarTree analyze_triangles(const RootTriangles& mesh, int depth, const Run& run);

}  // namespace prefilter
