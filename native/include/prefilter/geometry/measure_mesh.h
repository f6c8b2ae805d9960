// SPDX-License-Identifier: GPL-3.0-or-later

// Bounding box, area and volume of a mesh.
#pragma once

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

struct MeshMeasures {
  Box box = kEmptyBox;  // of the triangles; unused vertices do not count
  double area = 0.0;
  double volume = 0.0;  // enclosed; negative if inside out. For open meshes relative to a corner
};

/// Measures a mesh in one pass over the triangles, without copying them. The result is the same for
/// any number of threads. Throws Error for an invalid mesh; Error(kCancelled).
MeshMeasures measure_mesh(const InputMesh& mesh, const Run& run);

}  // namespace prefilter
