// SPDX-License-Identifier: GPL-3.0-or-later

// Surfaces that end where samples do.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/mesh_sink.h"

namespace prefilter {

/// Lengths are in local spacings: of the samples around, and at least a cell. All are from 0 on.
struct TrimOptions {
  double distance = 1.5;  // What is farther from all samples is cut,
  // but for regions that get no farther from them than this, and where the mesh does not end.
  double hole = 4.0;
  // Parts of fewer squared spacings go where anything was cut, but for the largest.
  double island = 12.0;
};

struct TrimReport {
  double cut = 0.0;         // the share of the surface that was far from all samples
  std::size_t islands = 0;  // the parts that went
  double island = 0.0;      // their share of the surface
};

/// A mesh, with what is told of its vertices.
struct TrimmedMesh {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<float> attributes;
};

/// Cuts a mesh along the line at which vertices are `distance` from all samples; between vertices
/// that follows from a straight edge. Attributes are `width` values for each vertex, of which the
/// last two are the distance from the samples, in local spacings, and their density, per area.
/// Where the mesh is two-manifold, so is the result, with boundaries. If nothing is cut, the mesh
/// is as it was.
///
/// Throws Error for options out of range, triangles that name no vertex, and distances or densities
/// that are not finite, or below 0; Error(kCancelled).
TrimReport trim_surface(std::span<const Vector3> positions,
                        std::span<const std::array<std::int32_t, 3>> triangles,
                        std::span<const float> attributes, std::size_t width,
                        const TrimOptions& options, const Progress& progress, TrimmedMesh* result);

}  // namespace prefilter
