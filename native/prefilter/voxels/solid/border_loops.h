// SPDX-License-Identifier: GPL-3.0-or-later

// Extracts the boundary loops of a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Loops of the edges that a mesh lacks for each edge to be traversed as often in one direction as
/// in the other. Vertices with equal positions are represented by the first of them.
struct BorderLoops {
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  std::size_t open_edges = 0;             // unbalanced: traversed more often in one direction
  std::vector<std::size_t> begins = {0};  // offset of each loop in the lists below, and their end
  std::vector<std::uint32_t> vertices;    // vertices of the loops, unique within a loop
  // face at the edge from each vertex to the next; kNone if there are several
  std::vector<std::uint32_t> faces;
  std::vector<std::uint32_t> parts;  // component of each vertex of the mesh, connected by triangles

  std::size_t size() const { return begins.size() - 1; }
  std::span<const std::uint32_t> loop(std::size_t i) const {
    return std::span(vertices).subspan(begins[i], begins[i + 1] - begins[i]);
  }
  std::span<const std::uint32_t> faces_beside(std::size_t i) const {
    return std::span(faces).subspan(begins[i], begins[i + 1] - begins[i]);
  }
};

/// Finds the loops of a mesh that passed check_mesh. `parts` is empty if there are no loops. The
/// result does not depend on the number of threads. Throws Error(kCancelled).
BorderLoops border_loops(const InputMesh& mesh, const Run& run);

}  // namespace prefilter
