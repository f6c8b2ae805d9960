// SPDX-License-Identifier: GPL-3.0-or-later

// The box, area and volume of a mesh.
#pragma once

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

struct MeshMeasures {
  Box box = kEmptyBox;  // of the triangles; vertices that none of them has do not count
  double area = 0.0;
  double volume = 0.0;  // enclosed; negative inside out. Of an open mesh, as seen from a corner
};

/// One pass over the triangles, which are not copied. The same for any number of threads. Throws
/// Error for a mesh that is no mesh; Error(kCancelled).
MeshMeasures measure_mesh(const InputMesh& mesh, const Progress& progress, int threads);

}  // namespace prefilter
