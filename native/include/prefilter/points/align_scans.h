// SPDX-License-Identifier: GPL-3.0-or-later

// Registration of overlapping scans.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/rigid_motion.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Points of a scan and their normals, of any length and sign; zero if unknown.
struct ScanView {
  std::span<const Vector3> positions;
  std::span<const Vector3> normals;
};

struct AlignOptions {
  /// Largest distance of corresponding points; by default 1/20 of the diagonal of all scans'
  /// bounding box.
  std::optional<double> reach;
  int iterations = 40;  // at most
  Run run;
};

struct Alignment {
  std::vector<RigidMotion> motions;  // one per scan; the first is the identity
  /// Median distance of points from the planes of other scans, before and after; 0 without pairs.
  double before = 0.0;
  double after = 0.0;
  /// Number of examined points of each scan that have a counterpart in another scan afterward. A
  /// scan with 0 has nothing to be aligned to, and does not move.
  std::vector<std::size_t> pairs;
};

/// Finds small motions of all scans except the first, so that points of each scan lie in the planes
/// of the nearest points of others: iterated least squares with Tukey weights, over all overlapping
/// scans at once. Pairs whose normals differ by more than 45 degrees and pairs beyond a scan's
/// border are ignored. The scans must be roughly aligned: within `reach`, and about 20 degrees.
///
/// Points and normals that are not finite, or above 1e150, are ignored. The result is the same for
/// any number of threads. Throws Error for fewer than two scans, a different number of normals, a
/// reach that is not above 0 and finite, or iterations outside 1 to 1000; Error(kCancelled).
Alignment align_scans(std::span<const ScanView> scans, const AlignOptions& options);

}  // namespace prefilter
