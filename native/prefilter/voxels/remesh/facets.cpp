// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/facets.h"

#include <algorithm>
#include <utility>

namespace prefilter {
namespace {

constexpr double kFacetsCreaseCosine = 0.9659258262890683;  // 15 degrees

// Side of a triangle, by its lower and its higher vertex.
struct CreaseSide {
  std::int32_t low;
  std::int32_t high;
  std::uint32_t side;
  bool operator<(const CreaseSide& other) const {
    if (low != other.low) return low < other.low;
    return high != other.high ? high < other.high : side < other.side;
  }
};

Vector3 unit_normal(const Patch& patch, const PatchTriangle& t) {
  const Vector3& a = patch.point(t.corners[0]);
  const Vector3 n = cross(patch.point(t.corners[1]) - a, patch.point(t.corners[2]) - a);
  const double size = length(n);
  return {n[0] / size, n[1] / size, n[2] / size};
}

// Sides that may be creases, sorted.
std::vector<CreaseSide> sides_of(std::span<const VertexKind> kinds,
                                 std::span<const std::int32_t> vertices, const Patch& patch) {
  const auto is_surface = [&](std::int32_t v) {
    return !kinds.empty() && kinds[as_index(vertices[as_index(v)])] == VertexKind::kSurface;
  };
  std::vector<CreaseSide> sides;
  for (std::size_t t = 0; t < patch.triangles.size(); ++t) {
    const auto& corners = patch.triangles[t].corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(corners[i], corners[(i + 1) % 3]);
      if (is_surface(low) || is_surface(high)) continue;
      sides.push_back({low, high, static_cast<std::uint32_t>(3 * t + i)});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

void set_crease(std::uint32_t side, Patch* patch) {
  std::uint8_t& creases = patch->triangles[side / 3].creases;
  creases = static_cast<std::uint8_t>(creases | (1U << (side % 3)));
}

void keep_corners(std::span<const VertexKind> kinds, std::span<const std::int32_t> vertices,
                  Patch* patch) {
  std::vector<std::uint8_t> counts(vertices.size(), 0);
  for (const PatchTriangle& t : patch->triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      std::uint8_t& count = counts[as_index(t.corners[i])];
      if (((t.creases >> i) & 1U) != 0 && count < 3) ++count;
    }
  }
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (kinds[as_index(vertices[v])] != VertexKind::kCorner || counts[v] == 2) continue;
    patch->flags[v] = static_cast<std::uint8_t>(patch->flags[v] | Patch::kFixed);
  }
}
}  // namespace

PatchVertices number_vertices(const PatchDivision& division, std::size_t patch,
                              std::span<const std::array<std::int32_t, 3>> triangles,
                              std::vector<std::int32_t>* vertex_indices) {
  PatchVertices vertices;
  std::vector<std::int32_t>& all = vertices.all;
  for (const std::uint32_t t : division.triangles(patch)) {
    for (const std::int32_t v : triangles[t]) {
      if (division.owners[as_index(v)] == PatchDivision::kShared) all.push_back(v);
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  vertices.shared = all.size();
  const auto owner = static_cast<std::int32_t>(patch);
  for (const std::uint32_t t : division.triangles(patch)) {
    for (const std::int32_t v : triangles[t]) {
      if (division.owners[as_index(v)] != owner) continue;
      const auto place = as_index((*vertex_indices)[as_index(v)]);
      if (place < all.size() && place >= vertices.shared && all[place] == v) continue;
      (*vertex_indices)[as_index(v)] = static_cast<std::int32_t>(all.size());
      all.push_back(v);
    }
  }
  return vertices;
}

void take_triangles(const Facets& facets, const PatchDivision& division, std::size_t patch,
                    const PatchVertices& vertices, const std::vector<std::int32_t>& vertex_indices,
                    const PatchFrame& frame, Patch* result) {
  const auto shared = std::span(vertices.all).first(vertices.shared);
  const auto number_of = [&](std::int32_t v) {
    if (division.owners[as_index(v)] != PatchDivision::kShared) return vertex_indices[as_index(v)];
    const auto it = std::lower_bound(shared.begin(), shared.end(), v);
    return static_cast<std::int32_t>(it - shared.begin());
  };
  const std::span<const std::uint32_t> chosen = division.triangles(patch);
  result->triangles.resize(chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::uint32_t t = chosen[i];
    PatchTriangle& copy = result->triangles[i];
    for (std::size_t k = 0; k < 3; ++k) copy.corners[k] = number_of(facets.triangles[t][k]);
    if (!facets.labels.empty()) copy.label = facets.labels[t];
    if (!facets.creases.empty()) copy.creases = facets.creases[t];
    if (!facets.errors.empty()) copy.error = facets.errors[t];
    if (!facets.deviations.empty()) copy.deviation = facets.deviations[t];
    if (!facets.crease_errors.empty()) copy.crease_errors = facets.crease_errors[t];
    if (facets.point_ends.empty()) continue;
    for (std::uint32_t p = t == 0 ? 0 : facets.point_ends[t - 1]; p < facets.point_ends[t]; ++p) {
      result->points.push_back({frame.local(facets.points[p]), copy.first_point});
      copy.first_point = static_cast<std::int32_t>(result->points.size()) - 1;
    }
  }
}

void find_creases(std::span<const VertexKind> kinds, std::span<const std::int32_t> vertices,
                  Patch* patch) {
  const std::vector<CreaseSide> sides = sides_of(kinds, vertices, *patch);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    if (sides[i].low != sides[i + 1].low || sides[i].high != sides[i + 1].high) continue;
    const PatchTriangle& a = patch->triangles[sides[i].side / 3];
    const PatchTriangle& b = patch->triangles[sides[i + 1].side / 3];
    const bool is_border = a.label != b.label && a.label != kNoLabel && b.label != kNoLabel;
    if (!is_border && (kinds.empty() || dot(unit_normal(*patch, a), unit_normal(*patch, b)) >=
                                            kFacetsCreaseCosine)) {
      continue;
    }
    set_crease(sides[i].side, patch);
    set_crease(sides[i + 1].side, patch);
  }
  if (!kinds.empty()) keep_corners(kinds, vertices, patch);
}

Facets facets_of(const Patch& patch, std::span<const std::int32_t> vertices,
                 const PatchFrame& frame, bool has_labels, bool has_creases) {
  Facets result;
  for (const PatchTriangle& t : patch.triangles) {
    if (t.corners[0] == t.corners[1]) continue;
    result.triangles.push_back({vertices[as_index(t.corners[0])], vertices[as_index(t.corners[1])],
                                vertices[as_index(t.corners[2])]});
    if (has_labels) result.labels.push_back(t.label);
    if (has_creases) {
      result.creases.push_back(t.creases);
      result.crease_errors.push_back(t.crease_errors);
    }
    result.errors.push_back(t.error);
    result.deviations.push_back(t.deviation);
    for (std::int32_t p = t.first_point; p >= 0; p = patch.points[as_index(p)].next) {
      result.points.push_back(frame.global(patch.points[as_index(p)].position));
    }
    result.point_ends.push_back(static_cast<std::uint32_t>(result.points.size()));
  }
  return result;
}

void append(Facets* facets, Facets* all) {
  const auto add = [](const auto& from, auto* to) {
    to->insert(to->end(), from.begin(), from.end());
  };
  const auto first = static_cast<std::uint32_t>(all->points.size());
  add(facets->triangles, &all->triangles);
  add(facets->labels, &all->labels);
  add(facets->creases, &all->creases);
  add(facets->errors, &all->errors);
  add(facets->deviations, &all->deviations);
  add(facets->crease_errors, &all->crease_errors);
  add(facets->points, &all->points);
  for (const std::uint32_t end : facets->point_ends) all->point_ends.push_back(first + end);
  *facets = {};
}

}  // namespace prefilter
