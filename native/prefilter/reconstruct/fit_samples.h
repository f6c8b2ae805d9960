// Vertices moved onto the surface of the samples around them.
//
// Beyond the text: the contour says where the surface is to a fraction of a cell, and how its parts
// hang together; where it runs the samples know better.
#pragma once

#include <optional>
#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/reconstruct/sample_index.h"

namespace prefilter {

/// The surface of the samples within a cell's side of a point, as seen from there.
struct LocalSurface {
  Vector3 normal{};       // of length 1
  double distance = 0.0;  // of the point from the surface, along the normal; in cells
};

/// None where there are no samples. With weights w = (1 - r^2)^2 for samples r cells away, the
/// distance is the mean of that from the plane through the mean sample, across the mean normal,
/// and that from the samples' own planes. Where the surface curves, the first is too large by as
/// much as the second is too small: samples of a sphere give the sphere, to the fourth order.
std::optional<LocalSurface> local_surface(const SampleIndex& index, const Vector3& point);

/// Moves a point, in cells, onto the surface around it.
void fit_to_samples(const SampleIndex& index, Vector3* point);

/// The attributes of the samples within a cell's side, weighted likewise; false where there are
/// none.
bool blend_attributes(const SampleIndex& index, const Vector3& point, std::span<float> attributes);

}  // namespace prefilter
