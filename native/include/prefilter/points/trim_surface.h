// SPDX-License-Identifier: GPL-3.0-or-later

// Trims surfaces where samples end.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/points/mesh_sink.h"

namespace prefilter {

/// Lengths are in local spacings: the spacing of the samples nearby, but at least a cell. All
/// values are nonnegative.
struct TrimOptions {
  double distance = 1.5;  // regions farther than this from all samples are cut
  // Except holes: interior regions that stay within this distance.
  double hole = 4.0;
  // If anything was cut, remaining parts of less area than this, in squared spacings, are removed,
  // except the largest.
  double island = 12.0;
};

struct TrimReport {
  double cut = 0.0;         // share of the surface that was far from all samples
  std::size_t islands = 0;  // number of parts removed
  double island = 0.0;      // their share of the surface
};

/// A mesh with vertex attributes.
struct TrimmedMesh {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<float> attributes;
};

/// Cuts a mesh along the line on which vertices are `distance` from all samples, interpolated
/// linearly along edges. Each vertex has `width` attributes; the last two are the distance from the
/// samples, in local spacings, and the sample density per area. A two-manifold mesh remains
/// two-manifold, with boundaries. If nothing is cut, the mesh is returned unchanged.
///
/// Throws Error for options out of range, triangles with invalid indices, and distances or
/// densities that are negative or not finite; Error(kCancelled).
TrimReport trim_surface(std::span<const Vector3> positions,
                        std::span<const std::array<std::int32_t, 3>> triangles,
                        std::span<const float> attributes, std::size_t width,
                        const TrimOptions& options, const Run& run, TrimmedMesh* result);

}  // namespace prefilter
