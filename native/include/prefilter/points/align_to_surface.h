// SPDX-License-Identifier: GPL-3.0-or-later

// Scans moved onto a surface of all of them.
#pragma once

#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/rigid_motion.h"
#include "prefilter/points/align_scans.h"

namespace prefilter {

/// Scans that were moved before, each moved on by itself, so that its points lie on a surface:
/// iterated least squares of the distances from the planes of the triangles nearest to them, with
/// weights as in align_scans. Triangles whose normals are more than 45 degrees from those of
/// points, to the same side, do not count, nor does what lies beyond the surface's border. Then all
/// are moved as one, so that the first is where it was.
///
/// The reach is at most four spacings of points. `before` and `after` are the median distances from
/// the surface; `pairs` counts points of which the surface has a counterpart. The same for any
/// number of threads. Throws Error as align_scans, but for one scan, and for another number of
/// motions than of scans, or a surface of no triangle, or of others than NearestPoints takes;
/// Error(kCancelled).
Alignment align_to_surface(std::span<const ScanView> scans, std::span<const RigidMotion> motions,
                           const InputMesh& surface, const AlignOptions& options);

}  // namespace prefilter
