// SPDX-License-Identifier: GPL-3.0-or-later

// Opens point files of any supported format.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "prefilter/points/point_source.h"
#include "prefilter/points/unpacked_file.h"

namespace prefilter {

/// Opens a file by its extension: .ply (also Gaussian splats), .pcd, .obj, .ptx, or lines of
/// numbers in .pts, .xyz, .xyzn, .asc, .txt and .csv. Throws Error(kFile) if it cannot be opened,
/// and Error for another extension or a file that does not match its extension.
std::unique_ptr<PointSource> open_points(const std::string& path);

/// Opens a PLY file that was compressed.
std::unique_ptr<PointSource> open_ply(const UnpackedFile& file);

/// The extensions that open_points supports, in lower case.
std::vector<std::string> point_extensions();

}  // namespace prefilter
