// SPDX-License-Identifier: GPL-3.0-or-later

// Whether points were seen from the origin of their coordinates.
#pragma once

#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// What the origin of coordinates is to a cloud.
enum class OriginRole {
  kNone,     // nothing that points tell
  kScanner,  // where these were seen from
  kEither,   // a scanner in a room, or the middle of an object: points tell no difference
};

inline constexpr Named<OriginRole> kOriginRoles[] = {{"none", OriginRole::kNone},
                                                     {"scanner", OriginRole::kScanner},
                                                     {"either", OriginRole::kEither}};

/// The origin may be the scanner's position where rays from it meet the points' surface once. Of a
/// camera's view, points are then spread about evenly over directions. Where points surround the
/// origin, they have to be spread more evenly over directions than over the surface: a scanner in
/// a room samples far walls more sparsely, and the points of an object do not know where the
/// origin is. Heights above a grid of x and y, or which the axis z of a camera would pass, are a
/// map's and kNone. So it is for fewer than 100 points, and for a view narrower than a twentieth of
/// its distance; points that are not finite do not count. The same to rounding for any order of up
/// to a million points, and for any number of threads. Throws Error(kCancelled).
OriginRole origin_role(std::span<const Vector3> points, const Progress& progress, int threads);

}  // namespace prefilter
