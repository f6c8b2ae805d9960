// SPDX-License-Identifier: GPL-3.0-or-later

// Features along their edges, from where their triangles face as the surfaces do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_set>

#include "prefilter/voxels/contour/feature_places.h"
#include "prefilter/voxels/contour/linked_loops.h"

namespace prefilter {

/// Where an edge is far from its loops, a loop's side may face the edge so obliquely that the
/// triangle from it to the nearest place is upside down. All that is given has to live as long.
class FeatureTurning {
 public:
  /// `turned` has the labels whose normals face inward.
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

  /// A place of a loop's feature, between those of its neighbors, that turns triangles upright;
  /// none where that is not needed, or where there is none.
  std::optional<Vector3> place(std::size_t loop, std::span<const Feature> features) const;

 private:
  struct Range;

  // Of ways from a feature along its edge.
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
