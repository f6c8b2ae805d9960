// SPDX-License-Identifier: GPL-3.0-or-later

// State of a contour that changes while its sharp loops are mended.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/voxels/contour/feature_places.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// The vertices of the contour, and its triangles: far from edges, near edges, and of sharp loops,
/// in this order.
struct LayeredMesh {
  FacetedMesh mesh;
  std::size_t contour_vertices = 0;
  std::size_t near = 0;   // first triangle near an edge
  std::size_t loops = 0;  // first triangle of a loop
};

/// State of each loop.
struct LoopStates {
  std::vector<Feature> features;
  std::vector<std::uint8_t> is_sharp;
  std::vector<std::uint8_t> is_single;  // must not be merged
  std::vector<std::size_t> merged;
  std::vector<std::uint8_t> attempts;
  std::vector<std::uint8_t> halvings;
};

/// Changes since the last search for intersections.
struct LoopChanges {
  std::vector<std::uint8_t> loops;
  std::vector<std::uint8_t> vertices;

  bool is_any() const { return has_any(loops) || has_any(vertices); }

 private:
  static bool has_any(const std::vector<std::uint8_t>& flags) {
    return std::find(flags.begin(), flags.end(), 1) != flags.end();
  }
};

}  // namespace prefilter
