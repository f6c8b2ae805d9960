// SPDX-License-Identifier: GPL-3.0-or-later

// What is around the folds of a contour is taken out of it, unfolded, and put back.
#include "prefilter/contour/unfold.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "prefilter/remesh/folds.h"

namespace prefilter {

std::vector<Vector3> halfway(const ContourTree& tree, const RootFrame& frame,
                             const SurfaceVertices& vertices) {
  std::vector<Vector3> positions = vertices.positions();
  const auto visit = [&](const auto& self, const CellNode& cell,
                         const CellCoordinates& at) -> void {
    const auto level = static_cast<std::size_t>(cell.depth);
    std::size_t vertex = vertices.first(level, cell.octants);
    for (std::uint64_t cuts = vertices.cuts(level, cell.octants); cuts != 0; cuts &= cuts - 1) {
      const int bit = std::countr_zero(cuts);
      const CellCoordinates leaf = octant_at(at, bit / 6);
      const auto axis = static_cast<std::size_t>(bit % 6 / 2);
      positions[vertex++][axis] = frame.position(
          static_cast<int>(axis), leaf[axis] + ((bit & 1) != 0 ? 1.0 : 0.0), cell.depth + 1);
    }
    for (int o = 0; o < 8; ++o) {
      const CellNode octant = tree.octant(cell, o);
      if (octant.is_split) self(self, octant, octant_at(at, o));
    }
  };
  if (tree.root().is_split) visit(visit, tree.root(), {0, 0, 0});
  return positions;
}

namespace {

constexpr int kSmoothings = 4;
constexpr int kMostRegions = 8;
constexpr int kRings = 4;  // around folds

using Triangle = std::array<std::int32_t, 3>;
using Flags = std::vector<std::uint8_t>;
using Pairs = std::vector<std::array<std::uint32_t, 2>>;

// The triangles around some of a contour's, with vertices of their own.
struct Region {
  std::vector<Vector3> positions;
  std::vector<Triangle> triangles;
  std::vector<std::size_t> vertices;  // of the contour
  Flags is_inner;                     // of each vertex: all triangles around it are here

  MeshView<std::int32_t> view() const { return {positions, triangles}; }
};

bool has_flagged(const Triangle& triangle, const Flags& flags) {
  return std::any_of(triangle.begin(), triangle.end(),
                     [&](std::int32_t v) { return flags[static_cast<std::size_t>(v)] != 0; });
}

Region region_around(const Pairs& pairs, const LoopedMesh& looped) {
  Flags is_inner(looped.positions.size(), 0);
  for (const auto& pair : pairs) {
    for (const std::uint32_t t : pair) {
      for (const std::int32_t v : looped.triangles[t]) is_inner[static_cast<std::size_t>(v)] = 1;
    }
  }
  for (int ring = 0; ring < kRings; ++ring) {
    Flags is_next = is_inner;
    for (const Triangle& triangle : looped.triangles) {
      if (!has_flagged(triangle, is_inner)) continue;
      for (const std::int32_t v : triangle) is_next[static_cast<std::size_t>(v)] = 1;
    }
    is_inner = std::move(is_next);
  }
  Region region;
  std::vector<std::int32_t> places(looped.positions.size(), -1);
  for (const Triangle& triangle : looped.triangles) {
    if (!has_flagged(triangle, is_inner)) continue;
    Triangle own;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(triangle[k]);
      if (places[v] < 0) {
        places[v] = static_cast<std::int32_t>(region.vertices.size());
        region.vertices.push_back(v);
        region.positions.push_back(looped.positions[v]);
        region.is_inner.push_back(is_inner[v]);
      }
      own[k] = places[v];
    }
    region.triangles.push_back(own);
  }
  return region;
}

// Of a region's triangles, those that fold, by vertices that may be moved.
class Folds {
 public:
  // Vertices of the contour from `vertices` on stay where they are, as those do that are sampled.
  Folds(const VertexSamples& samples, std::size_t vertices, Region* region)
      : region_(*region), is_movable_(region->vertices.size(), 0) {
    for (std::size_t v = 0; v < is_movable_.size(); ++v) {
      const std::size_t vertex = region->vertices[v];
      const bool is_sampled =
          !samples.index.empty() && vertex < vertices && samples.index[vertex] >= 0;
      if (vertex < vertices && !is_sampled) is_movable_[v] = 1;
    }
  }

  // Calls move(vertex) for the vertices of folds, each once; it returns whether it has.
  template <typename Move>
  bool move_vertices(const Move& move) {
    Flags is_seen(region_.positions.size(), 0);
    bool has_moved = false;
    for (const auto& pair : folded_pairs(region_.view(), 0, {})) {
      for (const std::uint32_t t : pair) {
        for (const std::int32_t corner : region_.triangles[t]) {
          const auto v = static_cast<std::size_t>(corner);
          if (is_movable_[v] == 0 || is_seen[v] != 0) continue;
          is_seen[v] = 1;
          if (!move(v)) continue;
          has_moved = true;
          if (region_.is_inner[v] == 0) reaches_out_ = true;
        }
      }
    }
    return has_moved;
  }

  // Whether a vertex has moved that has triangles outside.
  bool reaches_out() const { return reaches_out_; }

  // The mean of the vertices around each.
  std::vector<Vector3> means() const {
    std::vector<Vector3> sums(region_.positions.size());
    std::vector<double> counts(sums.size(), 0.0);
    for (const Triangle& corners : region_.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto v = static_cast<std::size_t>(corners[k]);
        for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3}) {
          sums[v] = sums[v] + region_.positions[static_cast<std::size_t>(corners[other])];
        }
        counts[v] += 2.0;
      }
    }
    for (std::size_t v = 0; v < sums.size(); ++v) {
      sums[v] = (1.0 / std::max(counts[v], 1.0)) * sums[v];
    }
    return sums;
  }

 private:
  Region& region_;
  Flags is_movable_;
  bool reaches_out_ = false;
};

// Returns whether what is around the region may fold since.
bool unfold_region(const VertexSamples& samples, Crossings* crossings, Region* region) {
  Folds folds(samples, crossings->fitted.size(), region);
  const auto put_back = [&](std::size_t v) {
    return crossings->put_back(region->vertices[v], &region->positions[v]);
  };
  while (folds.move_vertices(put_back)) {
  }
  // Between three cells of a gap even these may fold.
  for (int round = 0; round < kSmoothings; ++round) {
    std::vector<Vector3> means;
    const auto smooth = [&](std::size_t v) {
      if (means.empty()) means = folds.means();
      region->positions[v] = 0.5 * (region->positions[v] + means[v]);
      crossings->middle[region->vertices[v]] = region->positions[v];
      return true;
    };
    if (!folds.move_vertices(smooth)) break;
  }
  return folds.reaches_out();
}

}  // namespace

void unfold(const VertexSamples& samples, Crossings* crossings, LoopedMesh* looped) {
  for (int i = 0; i < kMostRegions; ++i) {
    const Pairs pairs = folded_pairs({looped->positions, looped->triangles}, 0, {});
    if (pairs.empty()) return;
    Region region = region_around(pairs, *looped);
    const bool goes_on = unfold_region(samples, crossings, &region);
    for (std::size_t v = 0; v < region.vertices.size(); ++v) {
      looped->positions[region.vertices[v]] = region.positions[v];
    }
    if (!goes_on) return;
  }
}

}  // namespace prefilter
