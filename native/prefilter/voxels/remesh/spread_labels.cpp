// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/spread_labels.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

namespace prefilter {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
using Neighbors = std::vector<std::array<std::uint32_t, 3>>;

struct EdgeSide {
  std::uint32_t end;
  std::uint32_t triangle;

  bool operator<(const EdgeSide& other) const {
    return end != other.end ? end < other.end : triangle < other.triangle;
  }
};

// Sides of triangles in consecutive lists, one per lower vertex.
struct EdgeSides {
  std::vector<EdgeSide> sides;
  std::vector<std::size_t> ends;  // ends of the lists
};

EdgeSides sides_of(const FacetedMesh& mesh) {
  const auto for_each = [&](const auto& take) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
        take(static_cast<std::size_t>(a), static_cast<std::uint32_t>(b),
             static_cast<std::uint32_t>(t));
      }
    }
  };
  EdgeSides result;
  result.ends.assign(mesh.positions.size() + 1, 0);
  for_each([&](std::size_t a, std::uint32_t, std::uint32_t) { ++result.ends[a + 1]; });
  std::partial_sum(result.ends.begin(), result.ends.end(), result.ends.begin());
  result.sides.resize(3 * mesh.triangles.size());
  for_each([&](std::size_t a, std::uint32_t b, std::uint32_t t) {
    result.sides[result.ends[a]++] = {b, t};
  });
  result.ends.pop_back();
  return result;
}

// The neighbors of triangles; where more than two share an edge, they are paired up.
Neighbors neighbors_of(const FacetedMesh& mesh) {
  EdgeSides edge_sides = sides_of(mesh);
  Neighbors beside(mesh.triangles.size(), {kNone, kNone, kNone});
  std::vector<std::uint8_t> known(mesh.triangles.size(), 0);
  std::size_t begin = 0;
  for (const std::size_t end : edge_sides.ends) {
    const std::span<EdgeSide> list(edge_sides.sides.data() + begin, end - begin);
    std::ranges::sort(list, std::less<>());
    for (std::size_t i = 0; i + 1 < list.size(); ++i) {
      if (list[i].end != list[i + 1].end) continue;
      const std::uint32_t t = list[i].triangle;
      const std::uint32_t u = list[i + 1].triangle;
      beside[t][known[t]++] = u;
      beside[u][known[u]++] = t;
      ++i;
    }
    begin = end;
  }
  return beside;
}
}  // namespace

int spread_labels(FacetedMesh* mesh, std::int32_t count, const Run& run) {
  const std::size_t triangles = mesh->triangles.size();
  mesh->labels.resize(triangles, kNoLabel);
  const Neighbors beside = neighbors_of(*mesh);
  run.report(0.8);
  std::vector<std::uint32_t> waiting;
  const auto spread = [&] {
    for (std::size_t next = 0; next < waiting.size(); ++next) {
      const std::uint32_t t = waiting[next];
      for (const std::uint32_t u : beside[t]) {
        if (u == kNone || mesh->labels[u] != kNoLabel) continue;
        mesh->labels[u] = mesh->labels[t];
        waiting.push_back(u);
      }
    }
    waiting.clear();
  };
  for (std::size_t t = 0; t < triangles; ++t) {
    if (mesh->labels[t] != kNoLabel) waiting.push_back(static_cast<std::uint32_t>(t));
  }
  spread();
  run.report(0.9);
  int added = 0;
  for (std::size_t t = 0; t < triangles; ++t) {
    if (mesh->labels[t] != kNoLabel) continue;
    mesh->labels[t] = count + added++;
    waiting.push_back(static_cast<std::uint32_t>(t));
    spread();
  }
  run.report(1.0);
  return added;
}

}  // namespace prefilter
