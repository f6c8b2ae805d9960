// SPDX-License-Identifier: GPL-3.0-or-later

// The points of PLY files.
#pragma once

#include <memory>
#include <string>

#include "prefilter/scan/point_source.h"

namespace prefilter {

/// The rows of "vertex", in text or binary of either endianness; all other elements and lists are
/// passed over. Throws Error for what is no PLY file, is damaged, or has no points; a point that
/// is missing, or one too many, is found when it is read.
std::unique_ptr<PointSource> open_ply_points(const std::string& path);

}  // namespace prefilter
