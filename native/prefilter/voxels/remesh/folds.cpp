// SPDX-License-Identifier: GPL-3.0-or-later

// No edge at a vertex folds if all normals around it are within 60 degrees of one of them. That
// leaves few vertices, and the edges between these.
#include "prefilter/voxels/remesh/folds.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/cancel_check.h"

namespace prefilter {
namespace {

using Flags = std::vector<std::uint8_t>;

// Side of a triangle, from its lower to its higher vertex.
struct FoldSide {
  std::uint32_t low;
  std::uint32_t high;
  std::uint32_t triangle;
};

Vector3 normal_of(const MeshView<std::int32_t>& mesh, std::size_t t) {
  const auto [a, b, c] = mesh.corners(t);
  return cross(b - a, c - a);
}

using Normal = std::array<float, 3>;

// The normal of length 1; 0 for triangles without area.
Normal unit_normal(const MeshView<std::int32_t>& mesh, std::size_t t) {
  const Vector3 normal = normal_of(mesh, t);
  const double size = std::sqrt(dot(normal, normal));
  if (!(size > 0.0)) return {};
  const double scale = 1.0 / size;
  return {static_cast<float>(scale * normal[0]), static_cast<float>(scale * normal[1]),
          static_cast<float>(scale * normal[2])};
}

// Flags vertices with a normal more than 60 degrees from the first one.
Flags rough_vertices(const MeshView<std::int32_t>& mesh, std::size_t first, const Flags& is_touched,
                     CancelCheck* cancel_check) {
  constexpr float kMinSimilarCosine = 0.51F;  // cosine
  std::vector<std::uint32_t> places(mesh.positions.size());
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < places.size(); ++v) {
    places[v] = count;
    count += is_touched[v];
  }
  std::vector<Normal> firsts(count);
  Flags is_rough(mesh.positions.size(), 0);
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    cancel_check->step();
    const auto& corners = mesh.triangles[t];
    const auto is_any = [&](std::int32_t v) {
      return is_touched[static_cast<std::size_t>(v)] != 0;
    };
    if (std::none_of(corners.begin(), corners.end(), is_any)) continue;
    const Normal normal = unit_normal(mesh, t);
    for (const std::int32_t corner : corners) {
      const auto v = static_cast<std::size_t>(corner);
      if (is_touched[v] == 0) continue;
      Normal& first_normal = firsts[places[v]];
      if (first_normal == Normal{}) first_normal = normal;
      const float cosine =
          normal[0] * first_normal[0] + normal[1] * first_normal[1] + normal[2] * first_normal[2];
      // Also true for triangles without a normal.
      if (!(cosine > kMinSimilarCosine)) is_rough[v] = 1;
    }
  }
  return is_rough;
}

// Sides between two flagged vertices, in order of their lower ends.
std::vector<FoldSide> sides_between(const MeshView<std::int32_t>& mesh, std::size_t first,
                                    const Flags& is_flagged, CancelCheck* cancel_check) {
  std::vector<FoldSide> sides;
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    cancel_check->step();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint32_t>(mesh.triangles[t][k]);
      const auto b = static_cast<std::uint32_t>(mesh.triangles[t][(k + 1) % 3]);
      if ((is_flagged[a] & is_flagged[b]) == 0) continue;
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(t)});
    }
  }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const FoldSide& s, const FoldSide& other) { return s.low < other.low; });
  return sides;
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> folded_pairs(const MeshView<std::int32_t>& mesh,
                                                       std::size_t first,
                                                       std::span<const std::uint8_t> is_suspect,
                                                       const Run& run) {
  CancelCheck cancel_check(run);
  const auto is_counted = [&](std::size_t t) { return is_suspect.empty() || is_suspect[t] != 0; };
  Flags is_touched(mesh.positions.size(), 0);
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    if (!is_counted(t)) continue;
    for (const std::int32_t v : mesh.triangles[t]) is_touched[static_cast<std::size_t>(v)] = 1;
  }
  const std::vector<FoldSide> sides = sides_between(
      mesh, first, rough_vertices(mesh, first, is_touched, &cancel_check), &cancel_check);
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
