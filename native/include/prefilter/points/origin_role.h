// SPDX-License-Identifier: GPL-3.0-or-later

// Detects whether points were scanned from the origin of their coordinates.
#pragma once

#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Relation of the origin to a cloud.
enum class OriginRole {
  kNone,     // no relation that the points reveal
  kScanner,  // position of the scanner
  kEither,   // a scanner in a room, or the middle of an object: the points do not tell which
};

inline constexpr Named<OriginRole> kOriginRoles[] = {{"none", OriginRole::kNone},
                                                     {"scanner", OriginRole::kScanner},
                                                     {"either", OriginRole::kEither}};

/// The origin may be the scanner's position if rays from it meet the surface once. In a camera's
/// view, the points must then be spread evenly over directions. Points that surround the origin
/// must be spread more evenly over directions than over the surface: a scanner in a room samples
/// far walls more sparsely, whereas the points of an object are independent of the origin. Heights
/// over a grid of x and y, or beside the z axis of a camera, are a map and yield kNone. So do fewer
/// than 100 points, and views narrower than a twentieth of their distance; points that are not
/// finite are ignored. Up to a million points, the result is the same, up to rounding, for any
/// order of the points, and for any number of threads. Throws Error(kCancelled).
OriginRole origin_role(std::span<const Vector3> points, const Run& run);

}  // namespace prefilter
