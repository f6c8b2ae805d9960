// SPDX-License-Identifier: GPL-3.0-or-later

// Leica's PTX.
#pragma once

#include <memory>
#include <string>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// Scans one after the other, each with its grid's columns and rows, its place, its axes, the
/// matrix that its points are to be multiplied with, as rows, and a line for each place in the
/// grid: x y z intensity, and a color, or none has. Points at the scanner, which saw nothing, are
/// left out; the others are placed by the matrix, and have its place as their viewpoint. Throws
/// Error for what is no such file; damaged lines behind the first scan's head are found when they
/// are read.
std::unique_ptr<PointSource> open_ptx_points(const std::string& path);

}  // namespace prefilter
