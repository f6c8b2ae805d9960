// SPDX-License-Identifier: GPL-3.0-or-later

// Scans of one thing moved onto each other.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/rigid_motion.h"

namespace prefilter {

/// Points of a scan, and a normal of each, of any length and direction; zero where it is not known.
struct ScanView {
  std::span<const Vector3> positions;
  std::span<const Vector3> normals;
};

struct AlignOptions {
  /// How far apart what belongs together may be; none: a 20th of the diagonal of all scans' box.
  std::optional<double> reach;
  int iterations = 40;  // at the most
  Progress progress;
  int threads = 0;
};

struct Alignment {
  std::vector<RigidMotion> motions;  // one for each scan; the first stays
  /// The median distance of points from the planes of other scans, before and after; 0 without any.
  double before = 0.0;
  double after = 0.0;
  /// How many points of each scan have a counterpart in others afterward, of those looked at: 0
  /// says that a scan has nothing to be aligned to, and stays.
  std::vector<std::size_t> pairs;
};

/// Small motions of all scans but the first at once, so that points of each lie in the planes of
/// those of others nearest to them: iterated least squares over pairs of points, whose weights fall
/// to 0 with the distance (Tukey's), of what all of them overlap. Pairs whose normals are more than
/// 45 degrees apart do not count, nor do those beyond a scan's border. The scans have to be near
/// their places: within `reach`, and about 20 degrees.
///
/// Points and normals that are not finite, or above 1e150, are left out. The same for any number
/// of threads. Throws Error for fewer than two scans, another number of normals than of points, a
/// reach that is not above 0 and finite, or iterations not from 1 to 1000; Error(kCancelled).
Alignment align_scans(std::span<const ScanView> scans, const AlignOptions& options);

}  // namespace prefilter
