// SPDX-License-Identifier: GPL-3.0-or-later

// Loops get vertices on the edges; then, as long as triangles intersect, the loops and vertices
// that are to blame go back some of the way.
#include "prefilter/contour/sharpen.h"

#include <algorithm>
#include <optional>
#include <unordered_set>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/contour/blamed_loops.h"
#include "prefilter/contour/facing.h"
#include "prefilter/contour/feature_places.h"
#include "prefilter/contour/linked_loops.h"
#include "prefilter/contour/loop_triangles.h"
#include "prefilter/contour/merged_loops.h"
#include "prefilter/contour/relaxed_features.h"
#include "prefilter/remesh/folds.h"
#include "prefilter/remesh/near_intersections.h"

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
bool has_any(const Changes& changes) { return has_any(changes.loops) || has_any(changes.vertices); }

LoopStates first_states(const LinkedLoops& loops, std::span<const Vector3> positions,
                        const VertexSamples& samples, const FeaturePlaces& places,
                        const Progress& progress, int threads) {
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

// The sample of a vertex whose line misses the surface; -1 for others, and where it is on its line.
std::int32_t off_line(std::int32_t vertex, const VertexSamples& samples,
                      std::span<const Vector3> positions) {
  const auto v = static_cast<std::size_t>(vertex);
  if (v >= samples.index.size() || samples.index[v] < 0) return -1;
  const auto sample = static_cast<std::size_t>(samples.index[v]);
  const bool is_off = samples.samples[sample].position != samples.on_lines[sample];
  return is_off && positions[v] != samples.on_lines[sample] ? samples.index[v] : -1;
}

// Moves sampled vertices that are off their lines along the surface: to where no triangle of theirs
// is upside down, or between those around them. Where that does not do, they go to their lines,
// which may be off the surface.
class OffLineVertices {
 public:
  OffLineVertices(const FeatureSurface& surface, const VertexSamples& samples,
                  const std::unordered_set<std::int32_t>& turned)
      : surface_(surface), samples_(samples), turned_(turned), moves_(samples.samples.size(), 0) {}

  // Takes those of a triangle; returns whether there are any.
  bool take(const Triangle& triangle, std::span<const Vector3> positions) {
    bool is_any = false;
    for (const std::int32_t corner : triangle) {
      const std::int32_t sample = off_line(corner, samples_, positions);
      if (sample < 0 || moves_[static_cast<std::size_t>(sample)] > kMostMoves) continue;
      taken_.push_back(corner);
      is_any = true;
    }
    return is_any;
  }

  // Flags those that have moved.
  void move(std::span<const Triangle> triangles, Flags* is_moved, std::vector<Vector3>* positions) {
    if (taken_.empty()) return;
    std::sort(taken_.begin(), taken_.end());
    taken_.erase(std::unique(taken_.begin(), taken_.end()), taken_.end());
    const std::vector<Around> around = look_around(triangles, *positions);
    for (std::size_t k = 0; k < taken_.size(); ++k) {
      const auto v = static_cast<std::size_t>(taken_[k]);
      (*positions)[v] = next_place((*positions)[v], around[k], samples_.index[v]);
      (*is_moved)[v] = 1;
    }
    taken_.clear();
  }

 private:
  static constexpr std::uint8_t kMostMoves = 3;
  static constexpr double kReachCells = 1.0;
  static constexpr double kBeyondCells = 0.1;

  // Of a vertex that is taken.
  struct Around {
    Vector3 mean{};    // of the vertices around it
    Vector3 across{};  // the way over the far side of a triangle that is upside down
  };

  Vector3 next_place(const Vector3& from, const Around& around, std::int32_t index) {
    const auto sample = static_cast<std::size_t>(index);
    if (moves_[sample]++ < kMostMoves) {
      const bool is_over = around.across != Vector3{};
      const Vector3 way = is_over ? around.across : 0.5 * (around.mean - from);
      const std::optional<SourcePoint> found = surface_.nearest(
          from + way, kReachCells * surface_.cell(), samples_.samples[sample].label);
      if (found) return found->position;
    }
    return samples_.on_lines[sample];
  }

  std::vector<Around> look_around(std::span<const Triangle> triangles,
                                  std::span<const Vector3> positions) const {
    std::vector<Around> around(taken_.size());
    std::vector<double> counts(taken_.size(), 0.0);
    const auto at = [&](std::int32_t v) -> const Vector3& {
      return positions[static_cast<std::size_t>(v)];
    };
    for (const Triangle& triangle : triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto found = std::lower_bound(taken_.begin(), taken_.end(), triangle[k]);
        if (found == taken_.end() || *found != triangle[k]) continue;
        const auto i = static_cast<std::size_t>(found - taken_.begin());
        const Vector3& a = at(triangle[(k + 1) % 3]);
        const Vector3& b = at(triangle[(k + 2) % 3]);
        around[i].mean = around[i].mean + a + b;
        counts[i] += 2.0;
        const Vector3 way = way_across(triangle[k], at(triangle[k]), a, b);
        if (dot(way, way) > dot(around[i].across, around[i].across)) around[i].across = way;
      }
    }
    for (std::size_t i = 0; i < around.size(); ++i) {
      around[i].mean = (1.0 / std::max(counts[i], 1.0)) * around[i].mean;
    }
    return around;
  }

  // From a vertex to beyond the line of two others, within the plane of its sample, where the
  // triangle of the three is upside down; 0 where it is not.
  Vector3 way_across(std::int32_t vertex, const Vector3& from, const Vector3& a,
                     const Vector3& b) const {
    const SourcePoint& sample = *samples_.of(vertex);
    const Vector3 up = turned_.contains(sample.label) ? -1.0 * sample.normal : sample.normal;
    const Vector3 inward = cross(up, b - a);
    const double size = length(inward);
    const double height = size > 0.0 ? dot(inward, from - a) / size : 0.0;
    if (!(height < 0.0)) return {};
    return ((kBeyondCells * surface_.cell() - height) / size) * inward;
  }

  const FeatureSurface& surface_;
  const VertexSamples& samples_;
  const std::unordered_set<std::int32_t>& turned_;
  std::vector<std::uint8_t> moves_;
  std::vector<std::int32_t> taken_;
};

// Of pairs of triangles: moves vertices that are off their lines; otherwise blames loops; otherwise
// puts vertices where they were before they were sampled. Flags the vertices that have moved.
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
        if (v >= crossings.fitted.size()) continue;
        if (!crossings.put_back(v, &mesh.positions[v])) continue;
        (*is_moved)[v] = 1;
      }
    }
  }
  const auto near = std::span<const Triangle>(mesh.triangles).subspan(layered->near);
  off_lines->move(near, is_moved, &mesh.positions);
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

// Those beside a loop lose or gain a joint.
void mark_around(std::size_t i, const LinkedLoops& loops, Flags* is_changed) {
  (*is_changed)[i] = 1;
  for (std::size_t k = 0; k < loops.side_count(i); ++k) {
    const std::int32_t other = loops.sides[i][k].other;
    if (other >= 0) (*is_changed)[static_cast<std::size_t>(other)] = 1;
  }
}

// What cannot reach the edge gets as close to it as it can.
void draw_back(std::size_t i, const LinkedLoops& loops, LoopStates* states, Flags* is_changed) {
  Feature& feature = states->features[i];
  feature.position = 0.5 * (feature.start + feature.position);
  if (++states->halvings[i] > kMostHalvings) states->is_sharp[i] = 0;
  mark_around(i, loops, is_changed);
}

// Vertices on their lines keep a triangle in its cell of the dual grid, which meets no other: left
// are the suspects of loops, and those with a vertex elsewhere.
Flags may_intersect(const LayeredMesh& layered, const Crossings& crossings, Flags is_suspect) {
  const auto is_on_line = [&](std::int32_t corner) {
    const auto v = static_cast<std::size_t>(corner);
    if (v >= crossings.fitted.size()) return true;  // inside of its cell
    const Vector3& at = layered.mesh.positions[v];
    const Vector3& fitted = crossings.fitted[v];
    return (at[0] != fitted[0]) + (at[1] != fitted[1]) + (at[2] != fitted[2]) <= 1;
  };
  for (std::size_t t = layered.near; t < layered.loops; ++t) {
    if (is_suspect[t] == 0) continue;
    const Triangle& corners = layered.mesh.triangles[t];
    if (std::all_of(corners.begin(), corners.end(), is_on_line)) is_suspect[t] = 0;
  }
  return is_suspect;
}

// Of the triangles that are suspect: those that intersect any, that fold, and that are upside down.
// Triangles of a plane that overlap need not intersect, by rounding: then one is upside down.
Pairs faulty_pairs(const LayeredMesh& layered, const Crossings& crossings, const Flags& is_suspect,
                   const FeatureSurface& surface, const VertexSamples& samples,
                   const std::unordered_set<std::int32_t>& turned, const Progress& progress,
                   int threads) {
  const double cell = surface.cell();
  const MeshView<std::int32_t> view{layered.mesh.positions, layered.mesh.triangles};
  const double side = kCubeCells * cell;
  const Flags may_meet =
      where_rough(view, layered.near, may_intersect(layered, crossings, is_suspect), side);
  // Among all triangles: those far from edges stay, and are in the way of what leaves its lines.
  Pairs pairs = near_intersections(view, 0, may_meet, side, progress, threads);
  for (const auto& fold : folded_pairs(view, 0, is_suspect)) {
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

// The loops that were drawn back, and the vertices that were moved, which may have their places
// where what was in their way has moved since.
class SecondTry {
 public:
  SecondTry(const LinkedLoops& loops, std::span<const Feature> wanted,
            std::span<const Vector3> wanted_places, LoopStates* states,
            std::vector<Vector3>* positions)
      : loops_(loops),
        states_(*states),
        positions_(*positions),
        settled_(*states),
        settled_places_(positions->begin(),
                        positions->begin() + static_cast<std::ptrdiff_t>(wanted_places.size())),
        is_tried_(loops.size(), 0),
        is_moved_(wanted_places.size(), 0) {
    for (std::size_t i = 0; i < loops.size(); ++i) {
      if (states->halvings[i] == 0) continue;
      is_tried_[i] = 1;
      states->features[i] = wanted[i];
      states->is_sharp[i] = 1;
    }
    for (std::size_t v = 0; v < wanted_places.size(); ++v) {
      if (positions_[v] == wanted_places[v]) continue;
      is_moved_[v] = 1;
      positions_[v] = wanted_places[v];
    }
  }

  Changes changed() const {
    Changes changes{Flags(loops_.size(), 0), is_moved_};
    for (std::size_t i = 0; i < loops_.size(); ++i) {
      if (is_tried_[i] != 0) mark_around(i, loops_, &changes.loops);
    }
    return changes;
  }

  // Puts those back that have a triangle of a pair, or all where none has; returns which changed.
  Changes give_up(const Pairs& pairs, const LoopTriangles& made, const LayeredMesh& layered) {
    Changes changes{Flags(loops_.size(), 0), Flags(is_moved_.size(), 0)};
    states_.is_single = settled_.is_single;
    for (const auto& pair : pairs) {
      for (const std::uint32_t t : pair) {
        for (const std::int32_t corner : layered.mesh.triangles[t]) {
          put_vertex_back(static_cast<std::size_t>(corner), &changes.vertices);
        }
        if (t < layered.loops) continue;
        for (const std::int32_t owner : made.owners[t - layered.loops]) {
          if (owner >= 0) put_back(static_cast<std::size_t>(owner), &changes.loops);
        }
      }
    }
    if (has_any(changes)) return changes;
    for (std::size_t i = 0; i < loops_.size(); ++i) put_back(i, &changes.loops);
    for (std::size_t v = 0; v < is_moved_.size(); ++v) put_vertex_back(v, &changes.vertices);
    return changes;
  }

 private:
  void put_back(std::size_t i, Flags* is_changed) {
    if (is_tried_[i] == 0) return;
    is_tried_[i] = 0;
    states_.features[i] = settled_.features[i];
    states_.is_sharp[i] = settled_.is_sharp[i];
    mark_around(i, loops_, is_changed);
  }

  void put_vertex_back(std::size_t v, Flags* is_changed) {
    if (v >= is_moved_.size() || is_moved_[v] == 0) return;
    is_moved_[v] = 0;
    positions_[v] = settled_places_[v];
    (*is_changed)[v] = 1;
  }

  const LinkedLoops& loops_;
  LoopStates& states_;
  std::vector<Vector3>& positions_;
  LoopStates settled_;
  std::vector<Vector3> settled_places_;
  Flags is_tried_;
  Flags is_moved_;
};
}  // namespace

FacetedMesh sharpen(LoopedMesh looped, const Crossings& crossings, const FeatureSurface& surface,
                    const VertexSamples& samples, const Progress& progress, int threads) {
  const double cell = surface.cell();
  const LinkedLoops loops =
      link_loops(std::move(looped.loops), surface, samples, progress.part(0.0, 0.1), threads);
  const std::unordered_set<std::int32_t> turned = turned_labels(samples);
  const FeaturePlaces places(surface);
  LoopStates states =
      first_states(loops, looped.positions, samples, places, progress.part(0.1, 0.5), threads);
  const std::vector<Feature> wanted = states.features;
  const std::vector<Vector3> wanted_places(
      looped.positions.begin(),
      looped.positions.begin() + static_cast<std::ptrdiff_t>(crossings.fitted.size()));
  LayeredMesh layered =
      without_loops(std::move(looped.positions), std::move(looped.triangles), samples);
  const std::size_t vertices = crossings.fitted.size();
  Changes changes{Flags(loops.size(), 1), Flags(vertices, 0)};
  for (std::size_t v = 0; v < vertices; ++v) {
    if (layered.mesh.positions[v] != crossings.fitted[v]) changes.vertices[v] = 1;
  }
  OffLineVertices off_lines(surface, samples, turned);
  const Progress checking = progress.part(0.6, 1.0);
  do {
    const LoopTriangles made =
        assemble(loops, looped.loop_triangles, samples, cell, &states, &changes.loops, &layered);
    const Flags is_suspect = suspects(layered, made, changes);
    const Pairs pairs =
        faulty_pairs(layered, crossings, is_suspect, surface, samples, turned, checking, threads);
    changes = {Flags(loops.size(), 0), Flags(vertices, 0)};
    std::vector<BlamedLoop> blamed = blame(pairs, made, states.is_sharp, states.attempts, crossings,
                                           &off_lines, &changes.vertices, &layered);
    for (const std::size_t i : relax_features(take_attempts(&states.attempts, &blamed), loops,
                                              states.is_sharp, places, &states.features)) {
      changes.loops[i] = 1;
    }
    for (const std::size_t i : fewest_loops(std::move(blamed), pairs.size())) {
      draw_back(i, loops, &states, &changes.loops);
    }
  } while (has_any(changes));
  SecondTry again(loops, wanted, wanted_places, &states, &layered.mesh.positions);
  changes = again.changed();
  while (has_any(changes)) {
    const LoopTriangles made =
        assemble(loops, looped.loop_triangles, samples, cell, &states, &changes.loops, &layered);
    const Flags is_suspect = suspects(layered, made, changes);
    const Pairs pairs =
        faulty_pairs(layered, crossings, is_suspect, surface, samples, turned, checking, threads);
    if (pairs.empty()) break;
    changes = again.give_up(pairs, made, layered);
  }
  return std::move(layered.mesh);
}

}  // namespace prefilter
