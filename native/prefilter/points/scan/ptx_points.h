// SPDX-License-Identifier: GPL-3.0-or-later

// Leica's PTX scans.
#pragma once

#include <memory>
#include <string>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// Opens a PTX file: consecutive scans, each with the columns and rows of its grid, the scanner's
/// position and axes, a matrix for row vectors, and a line "x y z intensity" per grid cell, in
/// which all points or none have a color. Points at the scanner are misses and are left out; others
/// are transformed by the matrix and have the scanner as their viewpoint. Throws Error for files in
/// another format; damage after the first scan's header is reported on reading.
std::unique_ptr<PointSource> open_ptx_points(const std::string& path);

}  // namespace prefilter
