// SPDX-License-Identifier: GPL-3.0-or-later

// Vertices of Wavefront OBJ files.
#pragma once

#include <memory>
#include <string>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// Opens an OBJ file as points, from its lines "v x y z". A single number after them is ignored;
/// three are a color, which becomes bytes: values up to 255 if any is above 1, otherwise up to 1.
/// If there are as many lines "vn" as vertices, they are the vertices' normals. Other lines are
/// ignored. Throws Error for a file without vertices; damage after the first thousands of lines is
/// reported on reading.
std::unique_ptr<PointSource> open_obj_points(const std::string& path);

}  // namespace prefilter
