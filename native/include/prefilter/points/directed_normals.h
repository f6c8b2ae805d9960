// SPDX-License-Identifier: GPL-3.0-or-later

// Orients normals of unknown sign.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Returns unit normals, some reversed, so that neighbors agree and each connected part points
/// outward on the whole, as in estimate_normals without a viewpoint. Zero for normals of length 0,
/// and for normals and points that are not finite. The result is the same for any number of
/// threads. Throws Error for no points, more than 2^31 - 1, or a different number of normals;
/// Error(kCancelled).
std::vector<Vector3> directed_normals(std::span<const Vector3> points,
                                      std::span<const Vector3> normals, const Run& run);

}  // namespace prefilter
