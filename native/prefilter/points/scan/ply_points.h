// SPDX-License-Identifier: GPL-3.0-or-later

// The points of PLY files.
#pragma once

#include <memory>
#include <string>

#include "prefilter/base/io/byte_reader.h"
#include "prefilter/points/point_source.h"

namespace prefilter {

/// The rows of "vertex", in text or binary of either endianness; all other elements and lists are
/// passed over. Throws Error for what is no PLY file, is damaged, or has no points; a point that
/// is missing, or one too many, is found when it is read. Gaussian splats: see
/// as_points_of_splats.
std::unique_ptr<PointSource> open_ply_points(const std::string& path);
std::unique_ptr<PointSource> open_ply_points(ByteReader bytes);

}  // namespace prefilter
