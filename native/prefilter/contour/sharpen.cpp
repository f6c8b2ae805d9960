// SPDX-License-Identifier: GPL-3.0-or-later

// Loops get vertices on the edges; then, as long as triangles intersect, the loops and vertices
// that are to blame go back some of the way.
#include "prefilter/contour/sharpen.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/contour/blamed_loops.h"
#include "prefilter/contour/facing.h"
#include "prefilter/contour/feature_places.h"
#include "prefilter/contour/linked_loops.h"
#include "prefilter/contour/loop_triangles.h"
#include "prefilter/contour/merged_loops.h"
#include "prefilter/contour/near_intersections.h"
#include "prefilter/contour/relaxed_features.h"

namespace prefilter {
namespace {

constexpr double kCubeCells = 2.0;
constexpr int kMostAttempts = 2;
constexpr int kMostHalvings = 3;
constexpr std::int64_t kLoopsPerTask = 64;

using Triangle = std::array<std::int32_t, 3>;
using Labels = std::vector<std::int32_t>;
using Flags = std::vector<std::uint8_t>;
using Pairs = std::vector<std::array<std::uint32_t, 2>>;

// The mesh while it is made: the vertices of the contour and the triangles far from edges, near
// them, and of sharp loops, in that order.
struct LayeredMesh {
  FacetedMesh mesh;
  std::size_t contour_vertices;
  std::size_t near;   // the first triangle near an edge
  std::size_t loops;  // the first triangle of a loop
};

// Of each loop.
struct LoopStates {
  std::vector<Feature> features;
  Flags is_sharp;
  Flags is_single;  // not to be merged
  std::vector<std::size_t> merged;
  std::vector<std::uint8_t> attempts;
  std::vector<std::uint8_t> halvings;
};

// Since intersections were looked for.
struct Changes {
  Flags loops;
  Flags vertices;
};

bool has_any(const Flags& flags) { return std::find(flags.begin(), flags.end(), 1) != flags.end(); }

Feature feature_of(const LinkedLoops& loops, std::size_t i, std::span<const Vector3> positions,
                   const VertexSamples& samples, const FeaturePlaces& places) {
  const SharpLoop& loop = loops.loops[i];
  const auto at = [&](std::int32_t v) -> const Vector3& {
    return positions[static_cast<std::size_t>(v)];
  };
  Vector3 start{};
  Labels labels;
  int divided = 0;
  for (std::size_t k = 0; k < loops.side_count(i); ++k) {
    if (const SourcePoint* sample = samples.of(loop.from(k))) labels.push_back(sample->label);
    if (!loops.sides[i][k].is_divided) continue;
    start = start + 0.5 * (at(loop.from(k)) + at(loop.to(k)));
    ++divided;
  }
  start = (1.0 / divided) * start;
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  return places.feature(start, std::move(labels));
}

LoopStates first_states(const LinkedLoops& loops, std::span<const Vector3> positions,
                        const VertexSamples& samples, const FeaturePlaces& places,
                        const Progress& progress, int threads) {
  LoopStates states;
  states.features.resize(loops.size());
  const auto place_some = [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      states.features[i] = feature_of(loops, i, positions, samples, places);
    }
  };
  parallel_ranges(static_cast<std::int64_t>(loops.size()), kLoopsPerTask, threads, progress,
                  place_some);
  places.claim_corners(&states.features);
  states.is_sharp.assign(loops.size(), 1);
  states.is_single.assign(loops.size(), 0);
  states.attempts.assign(loops.size(), 0);
  states.halvings.assign(loops.size(), 0);
  return states;
}

LayeredMesh without_loops(std::vector<Vector3> positions, std::vector<Triangle> triangles,
                          const VertexSamples& samples) {
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
  for (const Triangle& triangle : mesh.triangles) {
    mesh.labels.push_back(label_of(samples, triangle));
  }
  mesh.kinds.assign(mesh.positions.size(), VertexKind::kSurface);
  for (const std::int32_t tip : samples.tips) {
    mesh.kinds[static_cast<std::size_t>(tip)] = VertexKind::kCorner;
  }
  return made;
}

// Makes the triangles of loops anew. Where a vertex of several would not leave the mesh a
// two-manifold, each gets its own.
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

// The triangles near edges that have changed.
Flags suspects(const LayeredMesh& layered, const LoopTriangles& made, const Changes& changes) {
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

// Puts a sampled vertex back onto the line between its leaves; returns whether it was off that.
bool put_on_line(std::int32_t vertex, const VertexSamples& samples,
                 std::vector<Vector3>* positions) {
  const auto v = static_cast<std::size_t>(vertex);
  if (v >= samples.index.size() || samples.index[v] < 0) return false;
  const auto sample = static_cast<std::size_t>(samples.index[v]);
  if ((*positions)[v] != samples.samples[sample].position) return false;
  if ((*positions)[v] == samples.on_lines[sample]) return false;
  (*positions)[v] = samples.on_lines[sample];
  return true;
}

// Of pairs of triangles: puts vertices onto their lines; otherwise blames loops; otherwise puts
// vertices where they were before they were sampled. Flags the vertices that have moved.
std::vector<BlamedLoop> blame(const Pairs& pairs, const LoopTriangles& made, const Flags& is_sharp,
                              const VertexSamples& samples, std::span<const Vector3> crossings,
                              Flags* is_moved, LayeredMesh* layered) {
  FacetedMesh& mesh = layered->mesh;
  std::vector<BlamedLoop> blamed;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    bool has_moved = false;
    Labels loops;
    for (const std::uint32_t t : pairs[p]) {
      for (const std::int32_t corner : mesh.triangles[t]) {
        if (!put_on_line(corner, samples, &mesh.positions)) continue;
        (*is_moved)[static_cast<std::size_t>(corner)] = 1;
        has_moved = true;
      }
      if (t < layered->loops) continue;
      for (const std::int32_t owner : made.owners[t - layered->loops]) {
        if (owner >= 0 && is_sharp[static_cast<std::size_t>(owner)] != 0) loops.push_back(owner);
      }
    }
    if (has_moved) continue;
    std::sort(loops.begin(), loops.end());
    loops.erase(std::unique(loops.begin(), loops.end()), loops.end());
    for (const std::int32_t i : loops) blamed.push_back({i, p});
    if (!loops.empty()) continue;
    for (const std::uint32_t t : pairs[p]) {
      for (const std::int32_t corner : mesh.triangles[t]) {
        const auto v = static_cast<std::size_t>(corner);
        if (v >= crossings.size() || mesh.positions[v] == crossings[v]) continue;
        mesh.positions[v] = crossings[v];
        (*is_moved)[v] = 1;
      }
    }
  }
  return blamed;
}

// Takes out the loops that have been moved less often than they may, which it returns.
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

// What cannot reach the edge gets as close to it as it can.
void draw_back(std::size_t i, const LinkedLoops& loops, LoopStates* states, Flags* is_changed) {
  Feature& feature = states->features[i];
  feature.position = 0.5 * (feature.start + feature.position);
  if (++states->halvings[i] > kMostHalvings) states->is_sharp[i] = 0;
  (*is_changed)[i] = 1;
  // Those beside it lose a joint.
  for (std::size_t k = 0; k < loops.side_count(i); ++k) {
    const std::int32_t other = loops.sides[i][k].other;
    if (other >= 0) (*is_changed)[static_cast<std::size_t>(other)] = 1;
  }
}

// Of the triangles that are suspect: those that intersect any, and those upside down. Triangles of
// a plane that overlap need not intersect, by rounding: then one is upside down.
Pairs faulty_pairs(const LayeredMesh& layered, const Flags& is_suspect,
                   const VertexSamples& samples, const std::unordered_set<std::int32_t>& turned,
                   double cell, const Progress& progress, int threads) {
  const MeshView<std::int32_t> view{layered.mesh.positions, layered.mesh.triangles};
  Pairs pairs =
      near_intersections(view, layered.near, is_suspect, kCubeCells * cell, progress, threads);
  for (std::size_t t = layered.near; t < is_suspect.size(); ++t) {
    if (is_suspect[t] == 0) continue;
    if (!is_upside_down(view, t, layered.mesh.labels[t], samples, turned, cell)) continue;
    const auto number = static_cast<std::uint32_t>(t);
    pairs.push_back({number, number});
  }
  return pairs;
}
}  // namespace

FacetedMesh sharpen(LoopedMesh looped, const std::vector<Vector3>& crossings,
                    const FeatureSurface& surface, const VertexSamples& samples,
                    const Progress& progress, int threads) {
  const double cell = surface.cell();
  const LinkedLoops loops =
      link_loops(std::move(looped.loops), surface, samples, progress.part(0.0, 0.1), threads);
  const std::unordered_set<std::int32_t> turned = turned_labels(samples);
  const FeaturePlaces places(surface);
  LoopStates states =
      first_states(loops, looped.positions, samples, places, progress.part(0.1, 0.5), threads);
  LayeredMesh layered =
      without_loops(std::move(looped.positions), std::move(looped.triangles), samples);
  Changes changes{Flags(loops.size(), 1), Flags(crossings.size(), 0)};
  for (std::size_t v = 0; v < crossings.size(); ++v) {
    if (layered.mesh.positions[v] != crossings[v]) changes.vertices[v] = 1;
  }
  const Progress checking = progress.part(0.6, 1.0);
  do {
    const LoopTriangles made =
        assemble(loops, looped.loop_triangles, samples, cell, &states, &changes.loops, &layered);
    const Flags is_suspect = suspects(layered, made, changes);
    const Pairs pairs = faulty_pairs(layered, is_suspect, samples, turned, cell, checking, threads);
    changes = {Flags(loops.size(), 0), Flags(crossings.size(), 0)};
    std::vector<BlamedLoop> blamed =
        blame(pairs, made, states.is_sharp, samples, crossings, &changes.vertices, &layered);
    for (const std::size_t i : relax_features(take_attempts(&states.attempts, &blamed), loops,
                                              states.is_sharp, places, &states.features)) {
      changes.loops[i] = 1;
    }
    for (const std::size_t i : fewest_loops(std::move(blamed), pairs.size())) {
      draw_back(i, loops, &states, &changes.loops);
    }
  } while (has_any(changes.loops) || has_any(changes.vertices));
  return std::move(layered.mesh);
}

}  // namespace prefilter
