// SPDX-License-Identifier: GPL-3.0-or-later

// Points that scanners write where they saw nothing: many at exactly one position, such as 0, 0, 0.
#pragma once

#include <cstddef>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/point_source.h"

namespace prefilter {

/// A position at which many more points are than those around it explain.
struct PhantomPlace {
  Vector3 position{};
  std::size_t points = 0;
};

/// Those that hold 16 times as many points as positions around them usually do, or 4 times as many
/// where nothing else is near; and at least 4 points, or of many batches one point in 4096. Copies
/// of all points, and coordinates that are rounded, make no phantoms, as positions around then hold
/// as many points. In the order of their coordinates; the same for any order of the points. Reads
/// the source once, and again where there may be some. Throws Error(kCancelled).
std::vector<PhantomPlace> find_phantoms(PointSource* source, const Progress& progress, int threads);

}  // namespace prefilter
