// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/patch_links.h"

#include <utility>

namespace prefilter {

PatchLinks link_corners(std::size_t vertex_count, std::span<const PatchTriangle> triangles) {
  PatchLinks links;
  links.firsts.assign(vertex_count, -1);
  links.nexts.resize(3 * triangles.size());
  links.counts.assign(vertex_count, 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t v = as_index(triangles[t].corners[i]);
      const auto corner = static_cast<std::int32_t>(3 * t + i);
      std::int32_t& first = links.firsts[v];
      if (first < 0) {
        first = corner;
        links.nexts[as_index(corner)] = corner;
      } else {
        links.nexts[as_index(corner)] = links.nexts[as_index(first)];
        links.nexts[as_index(first)] = corner;
      }
      ++links.counts[v];
    }
  }
  return links;
}

void drop_corner(std::int32_t vertex, std::int32_t triangle, PatchLinks* links) {
  std::vector<std::int32_t>& nexts = links->nexts;
  std::int32_t before = links->firsts[as_index(vertex)];
  while (nexts[as_index(before)] / 3 != triangle) before = nexts[as_index(before)];
  const std::int32_t corner = nexts[as_index(before)];
  nexts[as_index(before)] = nexts[as_index(corner)];
  links->firsts[as_index(vertex)] = before;
  --links->counts[as_index(vertex)];
}

void move_corners(std::int32_t from, std::int32_t to, PatchLinks* links) {
  std::swap(links->nexts[as_index(links->firsts[as_index(from)])],
            links->nexts[as_index(links->firsts[as_index(to)])]);
  links->counts[as_index(to)] += links->counts[as_index(from)];
  links->counts[as_index(from)] = 0;
  links->firsts[as_index(from)] = -1;
}

bool find_ring(std::int32_t vertex, std::span<const PatchTriangle> triangles,
               const PatchLinks& links, std::vector<std::int32_t>* slots, Ring* ring) {
  const std::size_t count = links.count(vertex);
  if (count < 3 || count > kMaxNeighbors) return false;
  std::array<std::int32_t, kMaxNeighbors> around;
  std::array<std::uint8_t, kMaxNeighbors> corners;
  std::size_t filled = 0;
  links.for_corners(vertex, [&](std::int32_t t, std::int32_t corner) {
    around[filled] = t;
    corners[filled] = static_cast<std::uint8_t>(corner);
    (*slots)[as_index(triangles[as_index(t)].corners[as_index((corner + 1) % 3)])] =
        static_cast<std::int32_t>(filled);
    ++filled;
  });
  std::size_t at = 0;
  ring->size = count;
  ring->crease_count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const PatchTriangle& t = triangles[as_index(around[at])];
    const std::size_t corner = corners[at];
    ring->triangles[i] = around[at];
    ring->corners[i] = corners[at];
    ring->vertices[i] = t.corners[(corner + 1) % 3];
    ring->is_crease[i] = ((t.creases >> corner) & 1U) != 0;
    ring->crease_count += ring->is_crease[i] ? 1 : 0;
    at = as_index((*slots)[as_index(t.corners[(corner + 2) % 3])]);
    if (at == 0) return i + 1 == count;  // otherwise there are several fans
  }
  return false;
}

}  // namespace prefilter
