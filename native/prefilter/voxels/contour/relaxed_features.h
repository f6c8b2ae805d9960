// SPDX-License-Identifier: GPL-3.0-or-later

// Features of loops in order along their edge.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/contour/feature_places.h"
#include "prefilter/voxels/contour/feature_turning.h"
#include "prefilter/voxels/contour/linked_loops.h"

namespace prefilter {

/// Where an edge is far from the loops, as at the tip of a thin wedge, their nearest points of it
/// may be out of order. Moves the features of these loops, and of the next two on each side, on the
/// edge to between their neighbors', and on to where their triangles are upright; returns all of
/// these loops, in order.
std::vector<std::size_t> relax_features(std::vector<std::size_t> moving, const LinkedLoops& loops,
                                        std::span<const std::uint8_t> is_sharp,
                                        const FeaturePlaces& places, const FeatureTurning& turning,
                                        std::vector<Feature>* features);

}  // namespace prefilter
