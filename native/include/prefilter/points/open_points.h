// SPDX-License-Identifier: GPL-3.0-or-later

// Files of points, whatever their format.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "prefilter/points/point_source.h"
#include "prefilter/points/unpacked_file.h"

namespace prefilter {

/// Opens a file as its ending says: .ply, also of Gaussian splats; .pcd; .obj; .ptx; .pts, .xyz,
/// .xyzn, .asc, .txt or .csv, which are lines of numbers. Throws Error(kFile) where it cannot be
/// opened, else Error where the ending is another or the file is not what it says.
std::unique_ptr<PointSource> open_points(const std::string& path);

/// The same for a PLY file that was packed.
std::unique_ptr<PointSource> open_ply(const UnpackedFile& file);

/// The endings that open_points knows, in lower case.
std::vector<std::string> point_extensions();

}  // namespace prefilter
