// SPDX-License-Identifier: GPL-3.0-or-later

// The vertices of Wavefront OBJ files.
#pragma once

#include <memory>
#include <string>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// The lines "v x y z", with what may follow: a number that is passed over, or a color, which
/// becomes bytes: numbers up to 255 where some are above 1, else up to 1. Where there are as many
/// lines "vn" as vertices, they are the normals of these; all other lines are passed over. Throws
/// Error for a file without vertices; damaged lines behind the first thousands are found when they
/// are read.
std::unique_ptr<PointSource> open_obj_points(const std::string& path);

}  // namespace prefilter
