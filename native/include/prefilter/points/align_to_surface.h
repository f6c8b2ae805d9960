// SPDX-License-Identifier: GPL-3.0-or-later

// Registration of scans to a common surface.
#pragma once

#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/rigid_motion.h"
#include "prefilter/points/align_scans.h"

namespace prefilter {

/// Moves each scan, starting from its motion, onto a surface: iterated least squares of the
/// distances from the planes of the nearest triangles, with the weights of align_scans. Triangles
/// whose normals differ by more than 45 degrees from those of points, sign included, and points
/// beyond the surface's border are ignored. Finally, all scans are moved as one, so that the first
/// returns to its original position.
///
/// The reach is at most four times the point spacing. `before` and `after` are median distances
/// from the surface; `pairs` counts points with a counterpart on it. The result is the same for any
/// number of threads. Throws Error as align_scans does, except that one scan is allowed, and for a
/// different number of motions, a surface without triangles, or meshes that NearestPoints rejects;
/// Error(kCancelled).
Alignment align_to_surface(std::span<const ScanView> scans, std::span<const RigidMotion> motions,
                           const InputMesh& surface, const AlignOptions& options);

}  // namespace prefilter
