// SPDX-License-Identifier: GPL-3.0-or-later

// The points of PCD files, of the Point Cloud Library.
#pragma once

#include <memory>
#include <string>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// In text, binary, or compressed, which is unpacked to a temporary file. "rgb" and "rgba" become
/// red, green, blue and alpha; values that are several, and padding, are passed over. VIEWPOINT is
/// where the scanner stood, except for the origin in a cloud that is no image: it stands there,
/// too, where nothing is known. Throws Error for what is no PCD file or is damaged; in text, a
/// point that is missing, or one too many, is found when it is read.
std::unique_ptr<PointSource> open_pcd_points(const std::string& path);

}  // namespace prefilter
