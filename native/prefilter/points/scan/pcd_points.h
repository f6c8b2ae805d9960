// SPDX-License-Identifier: GPL-3.0-or-later

// Points of PCD files, the format of the Point Cloud Library.
#pragma once

#include <memory>
#include <string>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// Opens a PCD file: text, binary, or compressed, which is decompressed to a temporary file. "rgb"
/// and "rgba" become red, green, blue and alpha; fields with several values and padding are
/// ignored. VIEWPOINT is the scanner's position, unless it is the origin and the cloud is not
/// organized as an image: files without a known position have the origin, too. Throws Error for
/// files that are not PCD or are damaged; in text, missing or surplus points are reported on
/// reading.
std::unique_ptr<PointSource> open_pcd_points(const std::string& path);

}  // namespace prefilter
