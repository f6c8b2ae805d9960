// SPDX-License-Identifier: GPL-3.0-or-later

// In passes: each divides the mesh into patches of neighboring triangles, which are simplified by
// themselves, and each divides it elsewhere, so that the vertices that patches share get their
// turn.
#include "prefilter/voxels/remesh/simplify_facets.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/voxels/remesh/folds.h"
#include "prefilter/voxels/remesh/intersections.h"
#include "prefilter/voxels/remesh/near_intersections.h"
#include "prefilter/voxels/remesh/patch.h"
#include "prefilter/voxels/remesh/patch_division.h"

namespace prefilter {
namespace {

constexpr std::size_t kMeasuredEdges = 1U << 12;
constexpr int kMostPasses = 16;
// Of the tolerance, for the points that are measured; the rest is for what lies between them.
constexpr double kMeasuredShare = 0.78;
// A pass that removes less than this share of the triangles is the last one.
constexpr double kLeastRemoved = 0.02;
// Then patches that still meet others go back to what they were.
constexpr int kMostRepairs = 4;

// Of cubes that tell what is near.
double cube_of(const SimplifyScale& scale) {
  constexpr double kEdges = 4.0;
  return kEdges * scale.spacing * scale.tolerance;
}

using Triangle = std::array<std::int32_t, 3>;

// Of each vertex; each patch changes those that are its own.
struct VertexStates {
  std::vector<std::int32_t> places;      // in its patch
  std::vector<std::int32_t> targets;     // of those that are gone in this pass
  std::vector<std::uint8_t> is_waiting;  // surroundings have changed
  std::vector<std::uint8_t> is_frozen;   // stays, as intersections come of its end

  VertexStates(std::size_t count, std::vector<std::uint8_t> is_kept)
      : places(count, 0), targets(count, -1), is_waiting(count, 1), is_frozen(std::move(is_kept)) {
    is_frozen.resize(count, 0);
  }
};

// What becomes of a patch.
struct Part {
  Facets facets;
  std::vector<std::uint8_t> is_new;  // of triangles
};

// Positions and flags of a patch. Returns whether any vertex may be removable.
bool take_vertices(std::span<const Vector3> positions, const PatchVertices& vertices,
                   const VertexStates& states, const PatchFrame& frame, Patch* patch) {
  bool is_any_waiting = false;
  patch->positions.reserve(vertices.all.size());
  patch->flags.reserve(vertices.all.size());
  for (std::size_t i = 0; i < vertices.all.size(); ++i) {
    const std::size_t v = as_index(vertices.all[i]);
    patch->positions.push_back(frame.local(positions[v]));
    unsigned flags = i < vertices.shared ? unsigned{Patch::kShared} : 0U;
    if (states.is_frozen[v] != 0) flags |= Patch::kKept;
    if (states.is_waiting[v] != 0) {
      flags |= Patch::kWaiting;
      is_any_waiting = is_any_waiting || flags == Patch::kWaiting;
    }
    patch->flags.push_back(static_cast<std::uint8_t>(flags));
  }
  return is_any_waiting;
}

Part simplified(const FacetedMesh& mesh, const Facets& facets, const PatchDivision& division,
                std::size_t number, const SimplifyScale& scale, VertexStates* states) {
  const PatchVertices vertices =
      number_vertices(division, number, facets.triangles, &states->places);
  const PatchFrame frame = {mesh.positions[as_index(vertices.all.front())], scale.tolerance};
  const bool has_labels = !facets.labels.empty();
  const bool has_creases = has_labels || !mesh.kinds.empty();
  Patch patch;
  patch.spacing = scale.spacing;
  const bool is_any_waiting = take_vertices(mesh.positions, vertices, *states, frame, &patch);
  take_triangles(facets, division, number, vertices, states->places, frame, &patch);
  if (is_any_waiting) {
    if (has_creases) find_creases(mesh.kinds, vertices.all, &patch);
    simplify_patch(&patch);
  }
  for (std::size_t i = vertices.shared; i < vertices.all.size(); ++i) {
    const std::int32_t target = is_any_waiting ? patch.targets[i] : -1;
    states->targets[as_index(vertices.all[i])] = target < 0 ? -1 : vertices.all[as_index(target)];
  }
  Part part{facets_of(patch, vertices.all, frame, has_labels, has_creases), {}};
  for (const PatchTriangle& t : patch.triangles) {
    if (t.corners[0] != t.corners[1]) part.is_new.push_back(t.is_new ? 1 : 0);
  }
  return part;
}

// Keeps what was collapsed onto a bad vertex, or all that is the patch's own.
void freeze(const std::vector<Triangle>& triangles, const PatchDivision& division,
            std::size_t patch, const std::vector<std::uint8_t>& is_bad, bool all,
            VertexStates* states) {
  const auto owner = static_cast<std::int32_t>(patch);
  const auto is_own = [&](std::int32_t v) { return division.owners[as_index(v)] == owner; };
  for (const std::uint32_t t : division.triangles(patch)) {
    for (const std::int32_t v : triangles[t]) {
      if (!is_own(v) || states->is_frozen[as_index(v)] != 0) continue;
      std::int32_t end = v;
      while (is_own(end) && states->targets[as_index(end)] >= 0) {
        end = states->targets[as_index(end)];
      }
      if (all || is_bad[as_index(end)] != 0) states->is_frozen[as_index(v)] = 1;
    }
  }
}

// The patches whose new triangles meet others, or fold, or that these meet, and the vertices of
// both. Others than those that are flagged are known to be good among themselves.
struct Meetings {
  std::vector<std::int64_t> patches;
  std::vector<std::uint8_t> is_bad;
};

Meetings find_meetings(const std::vector<Vector3>& positions, const std::vector<Part>& parts,
                       const std::vector<std::uint8_t>& is_unknown, double side,
                       const Progress& progress, int threads) {
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> is_suspect;
  std::vector<std::uint32_t> patches;
  std::vector<std::int32_t> labels;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    labels.insert(labels.end(), parts[i].facets.labels.begin(), parts[i].facets.labels.end());
    const std::vector<Triangle>& some = parts[i].facets.triangles;
    triangles.insert(triangles.end(), some.begin(), some.end());
    patches.resize(triangles.size(), static_cast<std::uint32_t>(i));
    if (is_unknown[i] != 0) {
      is_suspect.insert(is_suspect.end(), parts[i].is_new.begin(), parts[i].is_new.end());
    }
    is_suspect.resize(triangles.size(), 0);
  }
  Meetings found;
  const NearTriangles near = near_triangles({positions, triangles}, 0, is_suspect, side, progress);
  if (near.triangles.empty()) return found;
  const MeshView<std::int32_t> view{positions, near.triangles};
  auto pairs = intersecting_triangles(view, near.is_suspect, progress, threads);
  for (auto& pair : pairs) pair = {near.numbers[pair[0]], near.numbers[pair[1]]};
  for (const auto& fold : folded_pairs(view, 0, near.is_suspect, progress)) {
    // Between regions there are edges of the shape, of any angle.
    const std::array<std::uint32_t, 2> pair = {near.numbers[fold[0]], near.numbers[fold[1]]};
    if (labels.empty() || labels[pair[0]] == labels[pair[1]]) pairs.push_back(pair);
  }
  if (pairs.empty()) return found;
  found.is_bad.assign(positions.size(), 0);
  std::vector<std::uint8_t> is_again(parts.size(), 0);
  for (const auto& pair : pairs) {
    for (const std::uint32_t t : pair) {
      is_again[patches[t]] = 1;
      for (const std::int32_t v : triangles[t]) found.is_bad[as_index(v)] = 1;
    }
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (is_again[i] != 0) found.patches.push_back(static_cast<std::int64_t>(i));
  }
  return found;
}

// Where new triangles meet others, the vertices that they come from stay.
void repair(const FacetedMesh& mesh, const Facets& facets, const PatchDivision& division,
            const SimplifyScale& scale, const Progress& progress, int threads, VertexStates* states,
            std::vector<Part>* parts) {
  std::vector<std::uint8_t> is_unknown(parts->size(), 1);
  for (int round = 0;; ++round) {
    const double begin = 1.0 - std::ldexp(1.0, -round);
    const Progress step = progress.part(begin, 1.0 - std::ldexp(1.0, -round - 1));
    const Meetings found = find_meetings(mesh.positions, *parts, is_unknown, cube_of(scale),
                                         step.part(0.0, 0.5), threads);
    if (found.patches.empty()) return;
    is_unknown.assign(parts->size(), 0);
    for (const std::int64_t patch : found.patches) is_unknown[static_cast<std::size_t>(patch)] = 1;
    const auto rerun = [&](std::int64_t i) {
      const auto patch = static_cast<std::size_t>(found.patches[static_cast<std::size_t>(i)]);
      freeze(facets.triangles, division, patch, found.is_bad, round >= kMostRepairs, states);
      (*parts)[patch] = simplified(mesh, facets, division, patch, scale, states);
    };
    parallel_for(static_cast<std::int64_t>(found.patches.size()), threads, step.part(0.5, 1.0),
                 rerun);
  }
}

Facets joined(std::vector<Part>* parts) {
  Facets all;
  std::size_t triangles = 0;
  std::size_t points = 0;
  for (const Part& part : *parts) {
    triangles += part.facets.triangles.size();
    points += part.facets.points.size();
  }
  all.triangles.reserve(triangles);
  all.point_ends.reserve(triangles);
  all.points.reserve(points);
  for (Part& part : *parts) {
    append(&part.facets, &all);
    part = {};
  }
  return all;
}

// Returns whether another pass is worth while. The mesh has no triangles: these are facets.
bool run_pass(int number, const FacetedMesh& mesh, const SimplifyScale& scale,
              std::span<const std::uint8_t> is_open, const Progress& progress, int threads,
              Facets* facets, VertexStates* states) {
  const std::size_t count = facets->triangles.size();
  PatchDivision division = divide_into_patches(mesh.positions, facets->triangles, number,
                                               progress.part(0.0, 0.1), threads);
  for (std::size_t v = 0; v < is_open.size(); ++v) {
    if (is_open[v] != 0) division.owners[v] = PatchDivision::kShared;
  }
  std::vector<Part> parts(division.count());
  const auto run = [&](std::int64_t i) {
    const auto patch = static_cast<std::size_t>(i);
    parts[patch] = simplified(mesh, *facets, division, patch, scale, states);
  };
  parallel_for(static_cast<std::int64_t>(parts.size()), threads, progress.part(0.1, 0.8), run);
  repair(mesh, *facets, division, scale, progress.part(0.8, 1.0), threads, states, &parts);
  *facets = joined(&parts);
  for (std::size_t v = 0; v < division.owners.size(); ++v) {
    if (division.owners[v] >= 0) states->is_waiting[v] = 0;
  }
  const std::size_t removed = count - facets->triangles.size();
  return division.count() > 1 && (number == 0 || static_cast<double>(removed) >=
                                                     kLeastRemoved * static_cast<double>(count));
}

}  // namespace

SimplifyScale scale_of(std::span<const Vector3> positions,
                       std::span<const std::array<std::int32_t, 3>> triangles, double tolerance) {
  SimplifyScale scale{kMeasuredShare * tolerance, 0.0};
  const std::size_t step = triangles.size() / kMeasuredEdges + 1;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t t = 0; t < triangles.size(); t += step) {
    const Triangle& triangle = triangles[t];
    sum += length(positions[as_index(triangle[1])] - positions[as_index(triangle[0])]) /
           scale.tolerance;
    ++count;
  }
  scale.spacing = sum / static_cast<double>(count);
  return scale;
}

void simplify_facets(const FacetedMesh& mesh, const SimplifyScale& scale, FixedVertices fixed,
                     const Progress& progress, int threads, Facets* facets) {
  VertexStates states(mesh.positions.size(), std::move(fixed.is_kept));
  double begin = 0.0;
  for (int i = 0; i < kMostPasses; ++i) {
    const double end = begin + 0.6 * (1.0 - begin);
    if (!run_pass(i, mesh, scale, fixed.is_open, progress.part(begin, end), threads, facets,
                  &states)) {
      break;
    }
    begin = end;
  }
}

}  // namespace prefilter
