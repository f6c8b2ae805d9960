// SPDX-License-Identifier: GPL-3.0-or-later

// Extracts the surroundings of a contour's folds, unfolds them, and writes them back.
#include "prefilter/voxels/contour/unfold.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "prefilter/voxels/contour/loop_triangles.h"
#include "prefilter/voxels/contour/unfolded_loops.h"
#include "prefilter/voxels/remesh/folds.h"
#include "prefilter/voxels/remesh/near_intersections.h"

namespace prefilter {

namespace {

// Calls visit(vertex, axis, position) for each vertex: the axis of its line, and the midpoint
// between its cells' centers along that line.
template <typename Visit>
void for_vertices(const ContourTree& tree, const RootFrame& frame, const SurfaceVertices& vertices,
                  const Visit& visit) {
  const auto descend = [&](const auto& self, const CellNode& cell,
                           const CellCoordinates& at) -> void {
    const auto level = static_cast<std::size_t>(cell.depth);
    std::size_t vertex = vertices.first(level, cell.octants);
    for (std::uint64_t cuts = vertices.cuts(level, cell.octants); cuts != 0; cuts &= cuts - 1) {
      const int bit = std::countr_zero(cuts);
      const CellCoordinates leaf = octant_at(at, bit / 6);
      const auto axis = static_cast<std::size_t>(bit % 6 / 2);
      visit(vertex++, axis,
            frame.position(static_cast<int>(axis), leaf[axis] + ((bit & 1) != 0 ? 1.0 : 0.0),
                           cell.depth + 1));
    }
    for (int o = 0; o < 8; ++o) {
      const CellNode octant = tree.octant(cell, o);
      if (octant.is_split) self(self, octant, octant_at(at, o));
    }
  };
  if (tree.root().is_split) descend(descend, tree.root(), {0, 0, 0});
}

}  // namespace

std::vector<Vector3> halfway(const ContourTree& tree, const RootFrame& frame,
                             const SurfaceVertices& vertices) {
  std::vector<Vector3> positions = vertices.positions();
  for_vertices(tree, frame, vertices, [&](std::size_t vertex, std::size_t axis, double place) {
    positions[vertex][axis] = place;
  });
  return positions;
}

Crossings crossings_of(const ContourTree& tree, const RootFrame& frame,
                       std::span<const Vector3> plain, const SurfaceVertices& vertices) {
  Crossings crossings(vertices.positions());
  for_vertices(tree, frame, vertices, [&](std::size_t vertex, std::size_t axis, double place) {
    crossings.set(vertex, axis, place, plain[vertex][axis]);
  });
  return crossings;
}

namespace {

constexpr int kUnfoldMostRegions = 8;
constexpr double kUnfoldCubeCells = 2.0;
constexpr int kUnfoldRings = 4;  // rings of triangles around folds
constexpr int kSlidingRings = 3;
constexpr int kMostRounds = 8;  // of sliding
// of unfolding loops; loops that share a side may undo each other's changes
constexpr int kMostPasses = 16;
constexpr double kLeastGain = 1e-3;
// Distances, in cells, by which vertices that fold at their midpoints slide; they stay nearest to
// these midpoints.
constexpr std::array<double, 4> kSlides = {0.12, -0.12, 0.24, -0.24};

using Triangle = std::array<std::int32_t, 3>;
using Flags = std::vector<std::uint8_t>;
using Pairs = std::vector<std::array<std::uint32_t, 2>>;

// Triangles around some of a contour's triangles, with vertices of their own.
struct Region {
  std::vector<Vector3> positions;
  std::vector<Triangle> triangles;
  std::vector<std::size_t> numbers;   // of the contour's triangles
  std::vector<std::size_t> vertices;  // of the contour
  Flags is_inner;                     // per vertex: all triangles around it are in the region

  MeshView<std::int32_t> view() const { return {positions, triangles}; }
};

bool has_flagged(const Triangle& triangle, const Flags& flags) {
  return std::any_of(triangle.begin(), triangle.end(),
                     [&](std::int32_t v) { return flags[static_cast<std::size_t>(v)] != 0; });
}

Region region_around(const Pairs& pairs, const MeshView<std::int32_t>& looped) {
  Flags is_inner(looped.positions.size(), 0);
  for (const auto& pair : pairs) {
    for (const std::uint32_t t : pair) {
      for (const std::int32_t v : looped.triangles[t]) is_inner[static_cast<std::size_t>(v)] = 1;
    }
  }
  for (int ring = 0; ring < kUnfoldRings; ++ring) {
    Flags is_next = is_inner;
    for (const Triangle& triangle : looped.triangles) {
      if (!has_flagged(triangle, is_inner)) continue;
      for (const std::int32_t v : triangle) is_next[static_cast<std::size_t>(v)] = 1;
    }
    is_inner = std::move(is_next);
  }
  Region region;
  std::vector<std::int32_t> places(looped.positions.size(), -1);
  for (std::size_t t = 0; t < looped.triangles.size(); ++t) {
    const Triangle& triangle = looped.triangles[t];
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
    region.numbers.push_back(t);
  }
  return region;
}

// The folds of a region with movable vertices.
class Folds {
 public:
  Folds(Region* region, Flags is_movable) : region_(*region), is_movable_(std::move(is_movable)) {}

  // Calls move(vertex) once for each vertex of folds; it returns whether the vertex moved.
  template <typename Move>
  bool move_vertices(const Move& move) {
    Flags is_seen(region_.positions.size(), 0);
    bool has_moved = false;
    for (const auto& pair : folded_pairs(region_.view(), 0, {}, {})) {
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

  // Whether a vertex with triangles outside the region moved.
  bool reaches_out() const { return reaches_out_; }

  // Whether all vertices of two triangles are movable.
  bool are_movable(const std::array<std::uint32_t, 2>& pair) const {
    return std::all_of(pair.begin(), pair.end(), [&](std::uint32_t t) {
      const Triangle& triangle = region_.triangles[t];
      return std::all_of(triangle.begin(), triangle.end(), [&](std::int32_t v) {
        return is_movable_[static_cast<std::size_t>(v)] != 0;
      });
    });
  }

 private:
  Region& region_;
  Flags is_movable_;
  bool reaches_out_ = false;
};

// Grid positions of a region's vertices between cells.
std::vector<GridPlace> places_of(const Region& region, const Vector3& cell,
                                 const Crossings& crossings) {
  std::vector<GridPlace> places(region.vertices.size(), kNoPlace);
  for (std::size_t v = 0; v < places.size(); ++v) {
    if (region.vertices[v] >= crossings.size()) continue;
    const Vector3& middle = crossings.middle(region.vertices[v]);
    for (std::size_t a = 0; a < 3; ++a) {
      places[v][a] = static_cast<std::int32_t>(std::lround(2.0 * middle[a] / cell[a]));
    }
  }
  return places;
}

// The numbers of a region's triangles around two of them.
std::vector<std::size_t> triangles_around(const std::array<std::uint32_t, 2>& pair,
                                          const Region& region) {
  Flags is_near(region.positions.size(), 0);
  std::vector<std::size_t> found = {pair[0], pair[1]};
  for (int ring = 0; ring < kSlidingRings; ++ring) {
    for (const std::size_t t : found) {
      for (const std::int32_t v : region.triangles[t]) is_near[static_cast<std::size_t>(v)] = 1;
    }
    found.clear();
    for (std::size_t t = 0; t < region.triangles.size(); ++t) {
      if (has_flagged(region.triangles[t], is_near)) found.push_back(t);
    }
  }
  return found;
}

// Total excess of folds beyond 120 degrees, in cosines.
double excess(const MeshView<std::int32_t>& mesh) {
  const auto normal_of = [&](std::uint32_t t) {
    const auto [a, b, c] = mesh.corners(t);
    return cross(b - a, c - a);
  };
  double sum = 0.0;
  for (const auto& pair : folded_pairs(mesh, 0, {}, {})) {
    const Vector3 a = normal_of(pair[0]);
    const Vector3 b = normal_of(pair[1]);
    sum += kFold - dot(a, b) / std::sqrt(dot(a, a) * dot(b, b));
  }
  return sum;
}

// A slide of a vertex, and the resulting triangles around it.
struct Slide {
  std::size_t vertex;
  Vector3 position;
  std::vector<Triangle> triangles;
};

// The slide of a vertex of two triangles that leaves the least folds around them. Vertices stay on
// their lines between two cells, so that triangles stay in their cubes.
std::optional<Slide> best_slide(const std::array<std::uint32_t, 2>& pair,
                                std::span<const std::size_t> around,
                                std::span<const GridPlace> places, const Vector3& cell,
                                const Crossings& crossings, Region* region) {
  std::vector<Triangle> before;
  for (const std::size_t t : around) before.push_back(region->triangles[t]);
  const auto folded = [&](const std::vector<Triangle>& triangles) {
    return folded_pairs({region->positions, triangles}, 0, {}, {});
  };
  double least = excess({region->positions, before}) - kLeastGain;
  std::optional<Slide> best;
  for (const std::uint32_t t : pair) {
    for (const std::int32_t corner : region->triangles[t]) {
      const auto v = static_cast<std::size_t>(corner);
      const Vector3 from = region->positions[v];
      for (const double share : kSlides) {
        Vector3& position = region->positions[v];
        position = crossings.middle(region->vertices[v]);
        for (std::size_t a = 0; a < 3; ++a) {
          if (places[v][a] % 2 == 0) position[a] = (0.5 * places[v][a] + share) * cell[a];
        }
        std::vector<Triangle> triangles = before;
        for (int pass = 0; pass < kMostPasses; ++pass) {
          if (!unfold_loops(region->positions, places, folded(triangles), &triangles)) break;
        }
        const double sum = excess({region->positions, triangles});
        if (sum >= least) continue;
        least = sum;
        best = {v, position, std::move(triangles)};
      }
      region->positions[v] = from;
    }
  }
  return best;
}

// Slides vertices of folded triangles as long as the folds decrease.
void slide(std::span<const GridPlace> places, const Vector3& cell, const Folds& folds,
           Crossings* crossings, Region* region) {
  bool has_slid = true;
  for (int round = 0; round < kMostRounds && has_slid; ++round) {
    has_slid = false;
    const Pairs pairs = folded_pairs(region->view(), 0, {}, {});
    double sum = excess(region->view());
    for (const auto& pair : pairs) {
      const std::array<Triangle, 2> both = {region->triangles[pair[0]], region->triangles[pair[1]]};
      if (!folds.are_movable(pair) || folded_pairs({region->positions, both}, 0, {}, {}).empty()) {
        continue;
      }
      const std::vector<std::size_t> around = triangles_around(pair, *region);
      const std::optional<Slide> best = best_slide(pair, around, places, cell, *crossings, region);
      if (!best) continue;
      const Vector3 position = std::exchange(region->positions[best->vertex], best->position);
      std::vector<Triangle> triangles = region->triangles;
      for (std::size_t i = 0; i < around.size(); ++i) triangles[around[i]] = best->triangles[i];
      triangles.swap(region->triangles);
      const double left = excess(region->view());
      if (left >= sum) {
        region->positions[best->vertex] = position;
        triangles.swap(region->triangles);
        continue;
      }
      sum = left;
      crossings->move_middle(region->vertices[best->vertex], best->position);
      has_slid = true;
    }
  }
}

// Flags vertices between cells that were not sampled.
Flags movable_vertices(const VertexSamples& samples, const Crossings& crossings,
                       const Region& region) {
  Flags is_movable(region.vertices.size(), 0);
  for (std::size_t v = 0; v < is_movable.size(); ++v) {
    const std::size_t vertex = region.vertices[v];
    if (vertex >= crossings.size()) continue;
    is_movable[v] = samples.index.empty() || samples.index[vertex] < 0 ? 1 : 0;
  }
  return is_movable;
}

void unfold_all_loops(std::span<const GridPlace> places, Region* region) {
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const auto pairs = folded_pairs(region->view(), 0, {}, {});
    if (!unfold_loops(region->positions, places, pairs, &region->triangles)) return;
  }
}

// Returns whether the surroundings of the region may have new folds.
bool unfold_region(const VertexSamples& samples, const Vector3& cell, Crossings* crossings,
                   Region* region) {
  const std::vector<GridPlace> places = places_of(*region, cell, *crossings);
  unfold_all_loops(places, region);
  Folds folds(region, movable_vertices(samples, *crossings, *region));
  const auto put_back = [&](std::size_t v) {
    return crossings->put_back(region->vertices[v], &region->positions[v]);
  };
  while (folds.move_vertices(put_back)) unfold_all_loops(places, region);
  // In a gap of three cells even these may fold.
  slide(places, cell, folds, crossings, region);
  return folds.reaches_out();
}

// Writes a region's vertices and triangles back into the mesh.
void write_back(const Region& region, std::vector<Vector3>* positions,
                std::vector<Triangle>* triangles) {
  for (std::size_t v = 0; v < region.vertices.size(); ++v) {
    (*positions)[region.vertices[v]] = region.positions[v];
  }
  for (std::size_t t = 0; t < region.numbers.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(region.triangles[t][k]);
      (*triangles)[region.numbers[t]][k] = static_cast<std::int32_t>(region.vertices[v]);
    }
  }
}

// Whether a vertex is on the line between its two cells.
bool is_on_line(std::size_t vertex, const Vector3& position, const Crossings& crossings) {
  if (vertex >= crossings.size()) return false;
  const Vector3& middle = crossings.middle(vertex);
  return (position[0] != middle[0]) + (position[1] != middle[1]) + (position[2] != middle[2]) <= 1;
}

// Folded pairs of triangles with all vertices on their lines, and some at midpoints; other folds
// were mended before.
Pairs plain_folds(const MeshView<std::int32_t>& mesh, const Crossings& crossings) {
  Flags is_halfway(mesh.positions.size(), 0);
  for (std::size_t v = 0; v < crossings.size(); ++v) {
    is_halfway[v] = mesh.positions[v] == crossings.middle(v) ? 1 : 0;
  }
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> numbers;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    if (!has_flagged(triangle, is_halfway)) continue;
    if (!std::all_of(triangle.begin(), triangle.end(), [&](std::int32_t corner) {
          const auto v = static_cast<std::size_t>(corner);
          return is_on_line(v, mesh.positions[v], crossings);
        })) {
      continue;
    }
    triangles.push_back(triangle);
    numbers.push_back(static_cast<std::uint32_t>(t));
  }
  Pairs pairs = folded_pairs({mesh.positions, triangles}, 0, {}, {});
  for (auto& [one, other] : pairs) {
    one = numbers[one];
    other = numbers[other];
  }
  return pairs;
}

// Flags the triangles of a region changed by another region, including by a moved vertex.
Flags changed_triangles(const Region& before, const Region& after, std::size_t count) {
  Flags is_changed(count, 0);
  for (std::size_t t = 0; t < before.numbers.size(); ++t) {
    const bool has_moved =
        std::any_of(after.triangles[t].begin(), after.triangles[t].end(), [&](std::int32_t v) {
          return after.positions[static_cast<std::size_t>(v)] !=
                 before.positions[static_cast<std::size_t>(v)];
        });
    if (has_moved || after.triangles[t] != before.triangles[t]) is_changed[before.numbers[t]] = 1;
  }
  return is_changed;
}

}  // namespace

void unfold(const VertexSamples& samples, const Vector3& cell, Crossings* crossings,
            LoopedMesh* looped) {
  for (int i = 0; i < kUnfoldMostRegions; ++i) {
    const Pairs pairs = folded_pairs({looped->positions, looped->triangles}, 0, {}, {});
    if (pairs.empty()) return;
    Region region = region_around(pairs, {looped->positions, looped->triangles});
    const bool goes_on = unfold_region(samples, cell, crossings, &region);
    write_back(region, &looped->positions, &looped->triangles);
    if (!goes_on) return;
  }
}

void unfold_plain_loops(const VertexSamples& samples, const Vector3& cell, Crossings* crossings,
                        const Run& run, FacetedMesh* mesh) {
  const MeshView<std::int32_t> view{mesh->positions, mesh->triangles};
  Pairs pairs = plain_folds(view, *crossings);
  if (pairs.empty()) return;
  const Region before = region_around(pairs, view);
  std::vector<GridPlace> places = places_of(before, cell, *crossings);
  Flags is_movable(places.size(), 0);
  for (std::size_t v = 0; v < places.size(); ++v) {
    const std::size_t vertex = before.vertices[v];
    if (!is_on_line(vertex, before.positions[v], *crossings)) {
      places[v] = kNoPlace;
    } else if (before.positions[v] == crossings->middle(vertex)) {
      is_movable[v] = 1;
    }
  }
  const double side = kUnfoldCubeCells * std::min({cell[0], cell[1], cell[2]});
  for (int i = 0; i < kUnfoldMostRegions; ++i) {
    Region region = before;
    unfold_all_loops(places, &region);
    slide(places, cell, Folds(&region, is_movable), crossings, &region);
    write_back(region, &mesh->positions, &mesh->triangles);
    const Flags is_changed = changed_triangles(before, region, mesh->triangles.size());
    pairs = near_intersections(view, 0, is_changed, side, run);
    if (pairs.empty()) {
      for (const std::size_t t : region.numbers) {
        if (is_changed[t] != 0) mesh->labels[t] = label_of(samples, mesh->triangles[t]);
      }
      return;
    }
    Flags stays(mesh->positions.size(), 0);
    for (const auto& pair : pairs) {
      for (const std::uint32_t t : pair) {
        for (const std::int32_t v : mesh->triangles[t]) stays[static_cast<std::size_t>(v)] = 1;
      }
    }
    for (std::size_t v = 0; v < places.size(); ++v) {
      if (stays[before.vertices[v]] == 0) continue;
      places[v] = kNoPlace;
      is_movable[v] = 0;
    }
    write_back(before, &mesh->positions, &mesh->triangles);
  }
}

}  // namespace prefilter
