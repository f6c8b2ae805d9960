// SPDX-License-Identifier: GPL-3.0-or-later

// Finds points that scanners write where there was no return: many at one position, such as 0, 0,
// 0.
#pragma once

#include <cstddef>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/points/point_source.h"

namespace prefilter {

/// A position with far more points than its surroundings explain.
struct PhantomPlace {
  Vector3 position{};
  std::size_t points = 0;
};

/// Returns positions with 16 times as many points as their neighbors usually have, or 4 times as
/// many if isolated; and at least 4 points, or one in 4096 of several batches. Repeated clouds and
/// rounded coordinates produce no phantoms, as the neighbors then have as many points. Sorted by
/// coordinates; independent of the order of the points. Reads the source once, and again if there
/// are candidates. Throws Error(kCancelled).
std::vector<PhantomPlace> find_phantoms(PointSource* source, const Run& run);

}  // namespace prefilter
