// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/smooth_stairs.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/remesh/folds.h"
#include "prefilter/voxels/remesh/near_intersections.h"

namespace prefilter {
namespace {

// Length of the area-weighted mean normal around a vertex: the cosine of half of 30 degrees.
// Slivers do not count, as their normals are random.
constexpr double kRough = 0.966;
constexpr int kRounds = 8;
constexpr double kShrinking = 0.5;
constexpr double kGrowing = -0.53;
constexpr double kFarthest = 0.5;  // cells
constexpr double kCube = 2.0;      // cells
constexpr int kMostReturns = 8;

using Flags = std::vector<std::uint8_t>;

std::span<const std::int32_t> corners_of(const FacetedMesh& mesh, std::size_t t) {
  return mesh.triangles[t];
}

// Flags vertices with very different normals around them.
Flags rough_vertices(const FacetedMesh& mesh) {
  std::vector<Vector3> sums(mesh.positions.size());
  std::vector<double> areas(sums.size(), 0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const auto at = [&](std::int32_t v) { return mesh.positions[static_cast<std::size_t>(v)]; };
    const Vector3 normal = cross(at(b) - at(a), at(c) - at(a));
    const double size = length(normal);
    for (const std::int32_t v : corners_of(mesh, t)) {
      sums[static_cast<std::size_t>(v)] = sums[static_cast<std::size_t>(v)] + normal;
      areas[static_cast<std::size_t>(v)] += size;
    }
  }
  Flags is_rough(sums.size(), 0);
  for (std::size_t v = 0; v < sums.size(); ++v) {
    const double least = kRough * areas[v];
    if (dot(sums[v], sums[v]) < least * least) is_rough[v] = 1;
  }
  return is_rough;
}

// Smooths the vertices that may move.
class Stairs {
 public:
  Stairs(double cell, const std::function<bool(const Vector3&)>& is_free, bool only_free,
         FacetedMesh* mesh)
      : cell_(cell), mesh_(*mesh) {
    const Flags is_rough = rough_vertices(mesh_);
    Flags is_near = is_rough;
    Flags is_beside_edge(is_rough.size(), 0);
    for (const auto& corners : mesh_.triangles) {
      const auto any = [&](const auto& holds) {
        return std::any_of(corners.begin(), corners.end(),
                           [&](std::int32_t v) { return holds(static_cast<std::size_t>(v)); });
      };
      const bool has_rough = any([&](std::size_t v) { return is_rough[v] != 0; });
      if (!has_rough) continue;
      const bool has_placed = any([&](std::size_t v) { return !is_surface(v); });
      for (const std::int32_t v : corners) {
        is_near[static_cast<std::size_t>(v)] = 1;
        if (has_placed) is_beside_edge[static_cast<std::size_t>(v)] = 1;
      }
    }
    places_.assign(is_near.size(), kNone);
    for (std::size_t v = 0; v < is_near.size(); ++v) {
      if (is_near[v] == 0 || !is_surface(v)) continue;
      const bool is_stair = is_rough[v] != 0 && is_beside_edge[v] == 0 && !only_free;
      if (!is_stair && !is_free(mesh_.positions[v])) continue;
      places_[v] = static_cast<std::uint32_t>(moved_.size());
      moved_.push_back(v);
      starts_.push_back(mesh_.positions[v]);
    }
    around_.resize(moved_.size());
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) add_neighbors(t);
  }

  bool is_empty() const { return moved_.empty(); }

  void smooth() {
    std::vector<Vector3> next = starts_;
    for (int round = 0; round < 2 * kRounds; ++round) {
      const double share = round % 2 == 0 ? kShrinking : kGrowing;
      for (std::size_t i = 0; i < next.size(); ++i) next[i] = smoothed(i, share);
      for (std::size_t i = 0; i < next.size(); ++i) mesh_.positions[moved_[i]] = next[i];
    }
  }

  // Flags triangles with moved vertices.
  Flags changed() const {
    Flags is_changed(mesh_.triangles.size(), 0);
    for (std::size_t t = 0; t < is_changed.size(); ++t) {
      for (const std::int32_t v : corners_of(mesh_, t)) {
        if (has_moved(static_cast<std::size_t>(v))) is_changed[t] = 1;
      }
    }
    return is_changed;
  }

  // Restores the vertices of triangles; returns whether any had moved.
  bool put_back(std::span<const std::array<std::uint32_t, 2>> pairs) {
    bool has_changed = false;
    for (const auto& pair : pairs) {
      for (const std::uint32_t t : pair) {
        for (const std::int32_t corner : corners_of(mesh_, t)) {
          const auto v = static_cast<std::size_t>(corner);
          if (!has_moved(v)) continue;
          mesh_.positions[v] = starts_[places_[v]];
          has_changed = true;
        }
      }
    }
    return has_changed;
  }

  void put_all_back() {
    for (std::size_t i = 0; i < moved_.size(); ++i) mesh_.positions[moved_[i]] = starts_[i];
  }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  bool is_surface(std::size_t v) const {
    return mesh_.kinds.empty() || mesh_.kinds[v] == VertexKind::kSurface;
  }

  bool has_moved(std::size_t v) const {
    return places_[v] != kNone && mesh_.positions[v] != starts_[places_[v]];
  }

  void add_neighbors(std::size_t t) {
    const auto corners = corners_of(mesh_, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t place = places_[static_cast<std::size_t>(corners[k])];
      if (place == kNone) continue;
      for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3}) {
        around_[place].push_back(corners[other]);
      }
    }
  }

  Vector3 smoothed(std::size_t i, double share) const {
    Vector3 sum{};
    for (const std::int32_t v : around_[i])
      sum = sum + mesh_.positions[static_cast<std::size_t>(v)];
    const Vector3& own = mesh_.positions[moved_[i]];
    const Vector3 mean = (1.0 / static_cast<double>(around_[i].size())) * sum;
    Vector3 next = own + share * (mean - own);
    for (std::size_t a = 0; a < 3; ++a) {
      next[a] =
          std::clamp(next[a], starts_[i][a] - kFarthest * cell_, starts_[i][a] + kFarthest * cell_);
    }
    return next;
  }

  double cell_;
  FacetedMesh& mesh_;
  std::vector<std::size_t> moved_;
  std::vector<Vector3> starts_;
  std::vector<std::uint32_t> places_;              // index of each vertex among the movable ones
  std::vector<std::vector<std::int32_t>> around_;  // neighbors, twice each
};

}  // namespace

void smooth_stairs(double cell, const std::function<bool(const Vector3&)>& is_free, bool only_free,
                   const Run& run, FacetedMesh* mesh) {
  Stairs stairs(cell, is_free, only_free, mesh);
  if (stairs.is_empty()) return;
  stairs.smooth();
  const MeshView<std::int32_t> view{mesh->positions, mesh->triangles};
  for (int i = 0; i < kMostReturns; ++i) {
    const Flags is_changed = stairs.changed();
    auto pairs = near_intersections(view, 0, is_changed, kCube * cell, run);
    const auto folds = folded_pairs(view, 0, is_changed, run);
    pairs.insert(pairs.end(), folds.begin(), folds.end());
    if (!stairs.put_back(pairs)) return;
  }
  stairs.put_all_back();
}

}  // namespace prefilter
