// SPDX-License-Identifier: GPL-3.0-or-later

// Where the normals around a vertex are all within 60 degrees of one direction no edge at it folds:
// that leaves few vertices, and the edges between these.
#include "prefilter/remesh/folds.h"

#include <algorithm>
#include <cmath>

namespace prefilter {
namespace {

using Flags = std::vector<std::uint8_t>;

// A side of a triangle from one end to a higher one.
struct Side {
  std::uint32_t low;
  std::uint32_t high;
  std::uint32_t triangle;
};

Vector3 normal_of(const MeshView<std::int32_t>& mesh, std::size_t t) {
  const auto [a, b, c] = mesh.corners(t);
  return cross(b - a, c - a);
}

// Calls visit(triangle, vertex) for triangles from `first` on and their flagged vertices.
template <typename Visit>
void for_corners(const MeshView<std::int32_t>& mesh, std::size_t first, const Flags& is_flagged,
                 const Visit& visit) {
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const unsigned flags = is_flagged[static_cast<std::size_t>(a)] |
                           is_flagged[static_cast<std::size_t>(b)] |
                           is_flagged[static_cast<std::size_t>(c)];
    if (flags == 0) continue;
    const Vector3 normal = normal_of(mesh, t);
    for (const std::int32_t corner : {a, b, c}) {
      const auto v = static_cast<std::size_t>(corner);
      if (is_flagged[v] != 0) visit(normal, v);
    }
  }
}

// Those of the vertices at which some normal is more than 60 degrees from their sum.
Flags rough_vertices(const MeshView<std::int32_t>& mesh, std::size_t first,
                     const Flags& is_touched) {
  constexpr double kLeast = 0.2501;  // squared cosine
  std::vector<std::uint32_t> places(mesh.positions.size());
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < places.size(); ++v) {
    places[v] = count;
    count += is_touched[v];
  }
  std::vector<Vector3> sums(count);
  for_corners(mesh, first, is_touched, [&](const Vector3& normal, std::size_t v) {
    sums[places[v]] = sums[places[v]] + normal;
  });
  Flags is_rough(mesh.positions.size(), 0);
  for_corners(mesh, first, is_touched, [&](const Vector3& normal, std::size_t v) {
    const Vector3& sum = sums[places[v]];
    const double product = dot(normal, sum);
    const bool is_close =
        product >= 0.0 && product * product >= kLeast * dot(normal, normal) * dot(sum, sum);
    if (!is_close) is_rough[v] = 1;
  });
  return is_rough;
}

// Those between two flagged vertices, in the order of their lower ends.
std::vector<Side> sides_between(const MeshView<std::int32_t>& mesh, std::size_t first,
                                const Flags& is_flagged) {
  std::vector<Side> sides;
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint32_t>(mesh.triangles[t][k]);
      const auto b = static_cast<std::uint32_t>(mesh.triangles[t][(k + 1) % 3]);
      if ((is_flagged[a] & is_flagged[b]) == 0) continue;
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(t)});
    }
  }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const Side& s, const Side& other) { return s.low < other.low; });
  return sides;
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> folded_pairs(const MeshView<std::int32_t>& mesh,
                                                       std::size_t first,
                                                       std::span<const std::uint8_t> is_suspect) {
  const auto is_counted = [&](std::size_t t) { return is_suspect.empty() || is_suspect[t] != 0; };
  Flags is_touched(mesh.positions.size(), 0);
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    if (!is_counted(t)) continue;
    for (const std::int32_t v : mesh.triangles[t]) is_touched[static_cast<std::size_t>(v)] = 1;
  }
  const std::vector<Side> sides =
      sides_between(mesh, first, rough_vertices(mesh, first, is_touched));
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    for (std::size_t j = i + 1; j < sides.size() && sides[j].low == sides[i].low; ++j) {
      if (sides[i].high != sides[j].high) continue;
      const std::uint32_t t = sides[i].triangle;
      const std::uint32_t u = sides[j].triangle;
      if (!is_counted(t) && !is_counted(u)) continue;
      const Vector3 a = normal_of(mesh, t);
      const Vector3 b = normal_of(mesh, u);
      if (dot(a, b) < kFold * std::sqrt(dot(a, a) * dot(b, b))) pairs.push_back({t, u});
    }
  }
  return pairs;
}

}  // namespace prefilter
