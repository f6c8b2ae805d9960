// SPDX-License-Identifier: GPL-3.0-or-later

// Moves features along their edges so that their triangles face the same way as the surfaces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_set>

#include "prefilter/voxels/contour/feature_places.h"
#include "prefilter/voxels/contour/linked_loops.h"

namespace prefilter {

/// Where an edge is far from its loops, a side of a loop may face it so obliquely that the triangle
/// to the nearest position is upside down. All arguments must outlive the object.
class FeatureTurning {
 public:
  /// `turned` contains the labels whose normals face inward.
  FeatureTurning(const LinkedLoops& loops, std::span<const std::uint8_t> is_sharp,
                 std::span<const Vector3> positions, const VertexSamples& samples,
                 const std::unordered_set<std::int32_t>& turned, const FeaturePlaces& places,
                 double cell)
      : loops_(loops),
        is_sharp_(is_sharp),
        positions_(positions),
        samples_(samples),
        turned_(turned),
        places_(places),
        cell_(cell) {}

  /// A position of a loop's feature, between its neighbors' features, for which all triangles are
  /// upright; none if no change is needed, or no position works.
  std::optional<Vector3> place(std::size_t loop, std::span<const Feature> features) const;

 private:
  struct Range;

  // Range of offsets from a feature along its edge.
  Range upright_range(std::size_t loop, std::span<const Feature> features,
                      const Vector3& along) const;

  const LinkedLoops& loops_;
  std::span<const std::uint8_t> is_sharp_;
  std::span<const Vector3> positions_;
  const VertexSamples& samples_;
  const std::unordered_set<std::int32_t>& turned_;
  const FeaturePlaces& places_;
  double cell_;
};

}  // namespace prefilter
