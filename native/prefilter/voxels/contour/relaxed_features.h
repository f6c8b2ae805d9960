// SPDX-License-Identifier: GPL-3.0-or-later

// Sorts the features of loops along their edge.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/contour/feature_places.h"
#include "prefilter/voxels/contour/feature_turning.h"
#include "prefilter/voxels/contour/linked_loops.h"

namespace prefilter {

/// Where an edge is far from the loops, as at the tip of a thin wedge, the nearest points of
/// adjacent loops may be out of order. Moves the features of these loops, and of the next two on
/// each side, to between their neighbors on the edge, and further to where their triangles are
/// upright; returns all of these loops, sorted.
std::vector<std::size_t> relax_features(std::vector<std::size_t> moving, const LinkedLoops& loops,
                                        std::span<const std::uint8_t> is_sharp,
                                        const FeaturePlaces& places, const FeatureTurning& turning,
                                        std::vector<Feature>* features);

}  // namespace prefilter
