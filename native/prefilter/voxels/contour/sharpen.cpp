// SPDX-License-Identifier: GPL-3.0-or-later

// Adds a vertex on the edge to each loop; then, as long as triangles intersect, retracts the
// responsible loops and vertices step by step.
#include "prefilter/voxels/contour/sharpen.h"

#include <algorithm>
#include <optional>
#include <unordered_set>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/voxels/contour/blamed_loops.h"
#include "prefilter/voxels/contour/facing.h"
#include "prefilter/voxels/contour/feature_places.h"
#include "prefilter/voxels/contour/feature_turning.h"
#include "prefilter/voxels/contour/linked_loops.h"
#include "prefilter/voxels/contour/loop_triangles.h"
#include "prefilter/voxels/contour/mended_loops.h"
#include "prefilter/voxels/contour/mending_zone.h"
#include "prefilter/voxels/contour/merged_loops.h"
#include "prefilter/voxels/contour/off_line_vertices.h"
#include "prefilter/voxels/contour/relaxed_features.h"
#include "prefilter/voxels/contour/second_try.h"
#include "prefilter/voxels/remesh/folds.h"
#include "prefilter/voxels/remesh/intersections.h"
#include "prefilter/voxels/remesh/near_intersections.h"

namespace prefilter {
namespace {

constexpr double kSharpenCubeCells = 2.0;
constexpr int kMostAttempts = 2;
constexpr int kMostHalvings = 3;
constexpr std::int64_t kSharpenLoopsPerTask = 64;

using Triangle = std::array<std::int32_t, 3>;
using Labels = std::vector<std::int32_t>;
using Flags = std::vector<std::uint8_t>;
using Pairs = std::vector<std::array<std::uint32_t, 2>>;

LoopStates first_states(const LinkedLoops& loops, std::span<const Vector3> positions,
                        const VertexSamples& samples, const FeaturePlaces& places, const Run& run) {
  LoopStates states;
  states.features.resize(loops.size());
  const auto place_some = [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const SharpLoop& loop = loops.loops[i];
      const auto is_divided = [&](std::size_t k) { return loops.sides[i][k].is_divided; };
      states.features[i] = *places.of_loop({loop.corners.data(), loops.side_count(i)}, positions,
                                           samples, is_divided);
    }
  };
  parallel_ranges(static_cast<std::int64_t>(loops.size()), kSharpenLoopsPerTask, run, place_some);
  places.claim_corners(&states.features);
  states.is_sharp.assign(loops.size(), 1);
  states.is_single.assign(loops.size(), 0);
  states.attempts.assign(loops.size(), 0);
  states.halvings.assign(loops.size(), 0);
  return states;
}

// Builds the layers, with space for all triangles that loops may get.
LayeredMesh without_loops(const LinkedLoops& loops, std::vector<Vector3> positions,
                          std::vector<Triangle> triangles, const VertexSamples& samples) {
  const auto is_far = [&](const Triangle& triangle) {
    return std::none_of(triangle.begin(), triangle.end(), [&](std::int32_t corner) {
      return static_cast<std::size_t>(corner) < samples.index.size() &&
             samples.of(corner) != nullptr;
    });
  };
  const auto far_end = std::stable_partition(triangles.begin(), triangles.end(), is_far);
  LayeredMesh made;
  made.contour_vertices = positions.size();
  made.near = static_cast<std::size_t>(far_end - triangles.begin());
  made.loops = triangles.size();
  FacetedMesh& mesh = made.mesh;
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  mesh.positions.reserve(mesh.positions.size() + loops.size());
  std::size_t most = 0;
  for (const SharpLoop& loop : loops.loops) {
    most += std::max(static_cast<std::size_t>(loop.count), loop.end - loop.first);
  }
  mesh.triangles.reserve(made.loops + most);
  mesh.labels.reserve(made.loops + most);
  for (const Triangle& triangle : mesh.triangles) {
    mesh.labels.push_back(label_of(samples, triangle));
  }
  mesh.kinds.assign(mesh.positions.size(), VertexKind::kSurface);
  for (const std::int32_t tip : samples.tips) {
    mesh.kinds[static_cast<std::size_t>(tip)] = VertexKind::kCorner;
  }
  return made;
}

// Rebuilds the triangles of loops. Where a shared vertex would make the mesh non-manifold, each
// loop gets its own.
LoopTriangles assemble(const LinkedLoops& loops, std::span<const Triangle> plain,
                       const VertexSamples& samples, double cell, LoopStates* states,
                       Flags* is_changed, LayeredMesh* layered) {
  FacetedMesh& mesh = layered->mesh;
  while (true) {
    std::vector<std::size_t> merged =
        merged_loops(loops, states->features, states->is_sharp, states->is_single, cell);
    mark_merged(states->merged, merged, is_changed);
    states->merged = std::move(merged);
    mesh.positions.resize(layered->contour_vertices);
    mesh.kinds.resize(layered->contour_vertices);
    mesh.triangles.resize(layered->loops);
    mesh.labels.resize(layered->loops);
    LoopTriangles made =
        add_loops(loops, plain, states->features, states->is_sharp, states->merged, samples, &mesh);
    const auto triangles = std::span<const Triangle>(mesh.triangles).subspan(layered->loops);
    if (!unmerge(triangles, made, states->merged, &states->is_single, is_changed)) return made;
  }
}

// Flags the changed triangles near edges.
Flags suspects(const LayeredMesh& layered, const LoopTriangles& made, const LoopChanges& changes) {
  const std::vector<Triangle>& triangles = layered.mesh.triangles;
  Flags is_suspect(triangles.size(), 0);
  for (std::size_t t = layered.near; t < triangles.size(); ++t) {
    for (const std::int32_t corner : triangles[t]) {
      const auto v = static_cast<std::size_t>(corner);
      if (v < changes.vertices.size() && changes.vertices[v] != 0) is_suspect[t] = 1;
    }
    if (t < layered.loops) continue;
    for (const std::int32_t owner : made.owners[t - layered.loops]) {
      if (owner >= 0 && changes.loops[static_cast<std::size_t>(owner)] != 0) is_suspect[t] = 1;
    }
  }
  return is_suspect;
}

// Resolves pairs of triangles: moves vertices that are off their lines; otherwise blames loops;
// otherwise moves vertices back to their positions before sampling. Flags the vertices moved.
std::vector<BlamedLoop> blame(const Pairs& pairs, const LoopTriangles& made, const Flags& is_sharp,
                              std::span<const std::uint8_t> attempts, const Crossings& crossings,
                              OffLineVertices* off_lines, Flags* is_moved, LayeredMesh* layered) {
  FacetedMesh& mesh = layered->mesh;
  std::vector<BlamedLoop> blamed;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    bool has_moved = false;
    Labels loops;
    for (const std::uint32_t t : pairs[p]) {
      has_moved |= off_lines->take(mesh.triangles[t], mesh.positions);
      if (t < layered->loops) continue;
      for (const std::int32_t owner : made.owners[t - layered->loops]) {
        if (owner >= 0 && is_sharp[static_cast<std::size_t>(owner)] != 0) loops.push_back(owner);
      }
    }
    std::sort(loops.begin(), loops.end());
    loops.erase(std::unique(loops.begin(), loops.end()), loops.end());
    for (const std::int32_t i : loops) {
      const bool may_move = attempts[static_cast<std::size_t>(i)] < kMostAttempts;
      if (!has_moved || may_move) blamed.push_back({i, p});
    }
    if (has_moved || !loops.empty()) continue;
    for (const std::uint32_t t : pairs[p]) {
      for (const std::int32_t corner : mesh.triangles[t]) {
        const auto v = static_cast<std::size_t>(corner);
        if (v >= crossings.size()) continue;
        if (!crossings.put_back(v, &mesh.positions[v])) continue;
        (*is_moved)[v] = 1;
      }
    }
  }
  const auto near = std::span<const Triangle>(mesh.triangles).subspan(layered->near);
  off_lines->move(near, is_moved, &mesh.positions);
  return blamed;
}

// Removes the loops that may be moved again from `blamed`, and returns them.
std::vector<std::size_t> take_attempts(std::vector<std::uint8_t>* attempts,
                                       std::vector<BlamedLoop>* blamed) {
  std::vector<std::size_t> moving;
  std::erase_if(*blamed, [&](const BlamedLoop& one) {
    const auto i = static_cast<std::size_t>(one.loop);
    if ((*attempts)[i] >= kMostAttempts) return false;
    moving.push_back(i);
    return true;
  });
  std::sort(moving.begin(), moving.end());
  moving.erase(std::unique(moving.begin(), moving.end()), moving.end());
  for (const std::size_t i : moving) ++(*attempts)[i];
  return moving;
}

// Features that cannot reach the edge stay as close to it as possible.
void draw_back(std::size_t i, const LinkedLoops& loops, LoopStates* states, Flags* is_changed) {
  Feature& feature = states->features[i];
  feature.position = 0.5 * (feature.start + feature.position);
  if (++states->halvings[i] > kMostHalvings) states->is_sharp[i] = 0;
  mark_around(i, loops, is_changed);
}

// A triangle whose vertices are on their lines stays in its cell of the dual grid and intersects no
// other. Returns the suspects of loops, and suspects with a vertex elsewhere.
Flags may_intersect(const LayeredMesh& layered, const Crossings& crossings, Flags is_suspect) {
  const auto is_on_line = [&](std::int32_t corner) {
    const auto v = static_cast<std::size_t>(corner);
    if (v >= crossings.size()) return true;  // inside its cell
    const Vector3& at = layered.mesh.positions[v];
    const Vector3 fitted = crossings.fitted(v);
    return (at[0] != fitted[0]) + (at[1] != fitted[1]) + (at[2] != fitted[2]) <= 1;
  };
  for (std::size_t t = layered.near; t < layered.loops; ++t) {
    if (is_suspect[t] == 0) continue;
    const Triangle& corners = layered.mesh.triangles[t];
    if (std::all_of(corners.begin(), corners.end(), is_on_line)) is_suspect[t] = 0;
  }
  return is_suspect;
}

// Intersecting pairs, among suspects that may intersect, and folded pairs.
struct MetPairs {
  Pairs intersecting;
  Pairs folded;
};

MetPairs met_pairs(const LayeredMesh& layered, const Crossings& crossings, const Flags& is_suspect,
                   double cell, const Run& run) {
  // If fewer than 1 / kFew of all triangles are suspect, nearby triangles are collected first.
  constexpr std::ptrdiff_t kFew = 8;
  // Triangles far from edges do not change, but may be hit by vertices that left their lines.
  const std::size_t first = 0;
  const MeshView<std::int32_t> view{layered.mesh.positions, layered.mesh.triangles};
  const double side = kSharpenCubeCells * cell;
  const Flags may_meet = keep_rough_suspects(
      view, layered.near, may_intersect(layered, crossings, is_suspect), side, run);
  const auto suspects = std::count(is_suspect.begin(), is_suspect.end(), std::uint8_t{1});
  if (kFew * suspects > std::ssize(is_suspect)) {
    return {near_intersections(view, first, may_meet, side, run),
            folded_pairs(view, first, is_suspect, run)};
  }
  const NearTriangles near = near_triangles(view, first, is_suspect, side, run);
  Flags near_may_meet(near.numbers.size());
  for (std::size_t i = 0; i < near.numbers.size(); ++i) {
    near_may_meet[i] = may_meet[near.numbers[i]];
  }
  const MeshView<std::int32_t> near_view{layered.mesh.positions, near.triangles};
  MetPairs met{intersecting_triangles(near_view, near_may_meet, run),
               folded_pairs(near_view, 0, near.is_suspect, run)};
  for (Pairs* pairs : {&met.intersecting, &met.folded}) {
    for (auto& [t, u] : *pairs) {
      t = near.numbers[t];
      u = near.numbers[u];
    }
  }
  return met;
}

// Pairs with suspect triangles that intersect, fold, or are upside down. Overlapping coplanar
// triangles may not intersect because of rounding, but then one of them is upside down.
Pairs faulty_pairs(const LayeredMesh& layered, const Crossings& crossings, const Flags& is_suspect,
                   const FeatureSurface& surface, const VertexSamples& samples,
                   const std::unordered_set<std::int32_t>& turned, const Run& run) {
  const double cell = surface.cell();
  const MeshView<std::int32_t> view{layered.mesh.positions, layered.mesh.triangles};
  MetPairs met = met_pairs(layered, crossings, is_suspect, cell, run);
  Pairs pairs = std::move(met.intersecting);
  for (const auto& fold : met.folded) {
    if (are_at_edge(view, layered.mesh.labels, fold, surface, samples, turned)) continue;
    pairs.push_back(fold);
  }
  for (std::size_t t = layered.near; t < is_suspect.size(); ++t) {
    if (is_suspect[t] == 0) continue;
    if (!is_upside_down(view, t, layered.mesh.labels[t], samples, turned, cell)) continue;
    const auto number = static_cast<std::uint32_t>(t);
    pairs.push_back({number, number});
  }
  return pairs;
}

// The scope of mending: everything, or a zone.
struct SharpenPlace {
  const LinkedLoops& loops;
  LoopStates& states;
  LayeredMesh& layered;
  LoopChanges& changes;
  std::span<const std::size_t> numbers;     // per loop: its number among all; empty: these are all
  std::span<const std::uint8_t> is_inside;  // per loop; empty: all are

  std::size_t number_of(std::size_t loop) const { return numbers.empty() ? loop : numbers[loop]; }
};

struct Faults {
  LoopTriangles made;
  Pairs pairs;
};

// A contour whose loops are mended until there are no faults.
class Mending {
 public:
  Mending(LinkedLoops loops, LoopedMesh looped, LoopStates states, const Crossings& crossings,
          const FeatureSurface& surface, const VertexSamples& samples, const Run& run)
      : crossings_(crossings),
        surface_(surface),
        samples_(samples),
        run_(run),
        threads_(run.threads()),
        turned_(turned_labels(samples)),
        off_lines_(surface, samples, turned_),
        loops_(std::move(loops)),
        plain_(std::move(looped.loop_triangles)),
        states_(std::move(states)),
        layered_(without_loops(loops_, std::move(looped.positions), std::move(looped.triangles),
                               samples)) {}

  FacetedMesh mend(const FeaturePlaces& places) {
    const std::vector<Feature> wanted = states_.features;
    std::vector<Vector3>& positions = layered_.mesh.positions;
    const std::size_t fitted = crossings_.size();
    const std::vector<Vector3> wanted_places(
        positions.begin(), positions.begin() + static_cast<std::ptrdiff_t>(fitted));
    changes_ = {Flags(loops_.size(), 1), Flags(fitted, 0)};
    for (std::size_t v = 0; v < fitted; ++v) {
      if (positions[v] != crossings_.fitted(v)) changes_.vertices[v] = 1;
    }
    do {
      visit_changed([&](SharpenPlace place) { give_way(places, &place); });
    } while (changes_.is_any());
    SecondTry again(loops_, wanted, wanted_places, &states_, &positions);
    changes_ = again.changed();
    while (changes_.is_any()) {
      Faulty found;
      visit_changed([&](SharpenPlace place) { found = faulty(&place); });
      if (!found.is_any) break;
      changes_ = again.give_up(found.loops, found.vertices);
    }
    assemble(loops_, plain_, samples_, surface_.cell(), &states_, &changes_.loops, &layered_);
    return std::move(layered_.mesh);
  }

 private:
  // Loops and vertices of faulty triangles.
  struct Faulty {
    bool is_any = false;
    std::vector<std::size_t> loops;
    std::vector<std::size_t> vertices;
  };

  template <typename Work>
  void visit_changed(const Work& work) {
    std::optional<MendingZone> zone;
    if (!ZoneFinder::are_most(changes_)) {
      if (!zones_) zones_.emplace(loops_, layered_, surface_.cell());
      zone = zones_->enter(loops_, states_, &changes_, &layered_);
    }
    if (!zone) {
      work(SharpenPlace{loops_, states_, layered_, changes_, {}, {}});
      return;
    }
    work(SharpenPlace{zone->loops, zone->states, zone->layered, zone->changes, zone->numbers,
                      zone->is_inside});
    ZoneFinder::leave(std::move(*zone), &states_, &changes_, &layered_);
  }

  // Clears the changes.
  Faults find_faults(SharpenPlace* place) {
    LoopChanges& changes = place->changes;
    Faults faults;
    faults.made = assemble(place->loops, plain_, samples_, surface_.cell(), &place->states,
                           &changes.loops, &place->layered);
    // At the border of a zone, loops lack their outside neighbors.
    for (std::size_t i = 0; i < place->is_inside.size(); ++i) {
      if (place->is_inside[i] == 0) changes.loops[i] = 0;
    }
    const Flags is_suspect = suspects(place->layered, faults.made, changes);
    faults.pairs =
        faulty_pairs(place->layered, crossings_, is_suspect, surface_, samples_, turned_, run_);
    changes = {Flags(changes.loops.size(), 0), Flags(changes.vertices.size(), 0)};
    return faults;
  }

  void give_way(const FeaturePlaces& places, SharpenPlace* place) {
    const auto& [made, pairs] = find_faults(place);
    LoopStates& states = place->states;
    Flags& is_changed = place->changes.loops;
    std::vector<BlamedLoop> blamed =
        blame(pairs, made, states.is_sharp, states.attempts, crossings_, &off_lines_,
              &place->changes.vertices, &place->layered);
    const FeatureTurning turning(place->loops, states.is_sharp, place->layered.mesh.positions,
                                 samples_, turned_, places, surface_.cell());
    for (const std::size_t i :
         relax_features(take_attempts(&states.attempts, &blamed), place->loops, states.is_sharp,
                        places, turning, &states.features)) {
      is_changed[i] = 1;
    }
    for (const std::size_t i : fewest_loops(std::move(blamed), pairs.size())) {
      draw_back(i, place->loops, &states, &is_changed);
    }
  }

  Faulty faulty(SharpenPlace* place) {
    const auto& [made, pairs] = find_faults(place);
    Faulty found;
    found.is_any = !pairs.empty();
    const LayeredMesh& layered = place->layered;
    for (const auto& pair : pairs) {
      for (const std::uint32_t t : pair) {
        for (const std::int32_t corner : layered.mesh.triangles[t]) {
          found.vertices.push_back(static_cast<std::size_t>(corner));
        }
        if (t < layered.loops) continue;
        for (const std::int32_t owner : made.owners[t - layered.loops]) {
          if (owner < 0) continue;
          found.loops.push_back(place->number_of(static_cast<std::size_t>(owner)));
        }
      }
    }
    return found;
  }

  const Crossings& crossings_;
  const FeatureSurface& surface_;
  const VertexSamples& samples_;
  const Run& run_;
  int threads_;
  std::unordered_set<std::int32_t> turned_;
  OffLineVertices off_lines_;
  LinkedLoops loops_;
  std::vector<Triangle> plain_;
  LoopStates states_;
  LayeredMesh layered_;
  LoopChanges changes_;
  std::optional<ZoneFinder> zones_;
};
}  // namespace

FacetedMesh sharpen(LoopedMesh looped, const Crossings& crossings, const FeatureSurface& surface,
                    const VertexSamples& samples, const Run& run) {
  LinkedLoops loops = link_loops(std::move(looped.loops), surface, samples, run.part(0.0, 0.1));
  const FeaturePlaces places(surface);
  LoopStates states = first_states(loops, looped.positions, samples, places, run.part(0.1, 0.5));
  const Run mending = run.part(0.6, 1.0);
  Mending contour(std::move(loops), std::move(looped), std::move(states), crossings, surface,
                  samples, mending);
  return contour.mend(places);
}

}  // namespace prefilter
