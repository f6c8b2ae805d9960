// SPDX-License-Identifier: GPL-3.0-or-later

// The borders of a mesh, as loops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// Loops of edges that a mesh lacks, so that with them each edge is traversed as often one way as
/// the other. Vertices at one place count as one: the first of them.
struct BorderLoops {
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  std::size_t open_edges = 0;             // unbalanced: traversed more often in one direction
  std::vector<std::size_t> begins = {0};  // of the loops in the lists below, and their end
  std::vector<std::uint32_t> vertices;    // a loop's, none twice
  std::vector<std::uint32_t> faces;  // beside the edge from a vertex to the next; kNone if several
  std::vector<std::uint32_t> parts;  // of each vertex of the mesh: equal where triangles join them

  std::size_t size() const { return begins.size() - 1; }
  std::span<const std::uint32_t> loop(std::size_t i) const {
    return std::span(vertices).subspan(begins[i], begins[i + 1] - begins[i]);
  }
  std::span<const std::uint32_t> faces_beside(std::size_t i) const {
    return std::span(faces).subspan(begins[i], begins[i + 1] - begins[i]);
  }
};

/// The mesh has been checked. `parts` is empty where there are no loops. The same for any number of
/// threads. Throws Error(kCancelled).
BorderLoops border_loops(const InputMesh& mesh, const Progress& progress, int threads);

}  // namespace prefilter
