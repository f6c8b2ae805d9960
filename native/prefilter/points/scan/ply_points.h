// SPDX-License-Identifier: GPL-3.0-or-later

// Points of PLY files.
#pragma once

#include <memory>
#include <string>

#include "prefilter/base/io/byte_reader.h"
#include "prefilter/points/point_source.h"

namespace prefilter {

/// Opens the element "vertex" of a PLY file, in text or binary of either byte order; other elements
/// and lists are ignored. Gaussian splats are converted (see as_points_of_splats). Throws Error for
/// files that are not PLY, are damaged or have no points; missing or surplus points are reported on
/// reading.
std::unique_ptr<PointSource> open_ply_points(const std::string& path);
std::unique_ptr<PointSource> open_ply_points(ByteReader bytes);

}  // namespace prefilter
