// SPDX-License-Identifier: GPL-3.0-or-later

// Simplifies in passes. Each pass divides the mesh into patches of neighboring triangles and
// simplifies these separately; the division differs between passes, so that vertices shared by
// patches get their turn.
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

constexpr std::size_t kMaxMeasuredEdges = 1U << 12;  // to estimate the mean edge length
constexpr int kMaxPasses = 16;
// Share of the tolerance for measured points; the remainder is for the surface between them.
constexpr double kMeasuredShare = 0.78;
// The last pass is the first that removes less than this share of the triangles.
constexpr double kMinRemovedShare = 0.02;
// Rounds after which patches that still intersect others are restored.
constexpr int kMaxRepairs = 4;

// Side of the grid cubes used to find nearby triangles.
double cube_side(const SimplifyScale& scale) {
  constexpr double kEdges = 4.0;  // mean edges per side
  return kEdges * scale.spacing * scale.tolerance;
}

using Triangle = std::array<std::int32_t, 3>;

// State of each vertex; patches change only their own.
struct VertexStates {
  std::vector<std::int32_t> local_indices;  // index in its patch
  std::vector<std::int32_t> targets;     // vertex that it was collapsed onto in this pass; -1: none
  std::vector<std::uint8_t> is_waiting;  // not tried since its surroundings changed
  std::vector<std::uint8_t> is_frozen;   // stays, because its removal caused intersections

  VertexStates(std::size_t count, std::vector<std::uint8_t> is_kept)
      : local_indices(count, 0),
        targets(count, -1),
        is_waiting(count, 1),
        is_frozen(std::move(is_kept)) {
    is_frozen.resize(count, 0);
  }
};

// The result of simplifying a patch.
struct SimplifiedPatch {
  Facets facets;
  std::vector<std::uint8_t> is_new;  // per triangle
};

// Copies the positions and flags of a patch. Returns whether any vertex may be removable.
bool take_vertices(std::span<const Vector3> positions, const PatchVertices& vertices,
                   const VertexStates& states, const PatchFrame& frame, Patch* patch) {
  bool is_any_waiting = false;
  patch->positions.reserve(vertices.all.size());
  patch->flags.reserve(vertices.all.size());
  for (std::size_t i = 0; i < vertices.all.size(); ++i) {
    const std::size_t v = as_index(vertices.all[i]);
    patch->positions.push_back(frame.local(positions[v]));
    unsigned flags = i < vertices.shared ? unsigned{Patch::kShared} : 0U;
    if (states.is_frozen[v] != 0) flags |= Patch::kFixed;
    if (states.is_waiting[v] != 0) {
      flags |= Patch::kPending;
      is_any_waiting = is_any_waiting || flags == Patch::kPending;
    }
    patch->flags.push_back(static_cast<std::uint8_t>(flags));
  }
  return is_any_waiting;
}

SimplifiedPatch simplified(const FacetedMesh& mesh, const Facets& facets,
                           const PatchDivision& division, std::size_t number,
                           const SimplifyScale& scale, VertexStates* states) {
  const PatchVertices vertices =
      number_vertices(division, number, facets.triangles, &states->local_indices);
  const PatchFrame frame = {mesh.positions[as_index(vertices.all.front())], scale.tolerance};
  const bool has_labels = !facets.labels.empty();
  const bool has_creases = has_labels || !mesh.kinds.empty();
  Patch patch;
  patch.spacing = scale.spacing;
  const bool is_any_waiting = take_vertices(mesh.positions, vertices, *states, frame, &patch);
  take_triangles(facets, division, number, vertices, states->local_indices, frame, &patch);
  if (is_any_waiting) {
    if (has_creases) find_creases(mesh.kinds, vertices.all, &patch);
    simplify_patch(&patch);
  }
  for (std::size_t i = vertices.shared; i < vertices.all.size(); ++i) {
    const std::int32_t target = is_any_waiting ? patch.targets[i] : -1;
    states->targets[as_index(vertices.all[i])] = target < 0 ? -1 : vertices.all[as_index(target)];
  }
  SimplifiedPatch part{facets_of(patch, vertices.all, frame, has_labels, has_creases), {}};
  for (const PatchTriangle& t : patch.triangles) {
    if (t.corners[0] != t.corners[1]) part.is_new.push_back(t.is_new ? 1 : 0);
  }
  return part;
}

// Freezes the vertices that were collapsed onto a bad vertex, or all vertices that the patch owns.
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

// Patches with new triangles that intersect others or fold, and the patches that these intersect,
// with all vertices involved. Only patches flagged as unknown need to be tested among themselves.
struct Conflicts {
  std::vector<std::int64_t> patches;
  std::vector<std::uint8_t> is_bad;
};

Conflicts find_conflicts(const std::vector<Vector3>& positions,
                         const std::vector<SimplifiedPatch>& parts,
                         const std::vector<std::uint8_t>& is_unknown, double side, const Run& run) {
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
  Conflicts conflicts;
  const NearTriangles near = near_triangles({positions, triangles}, 0, is_suspect, side, run);
  if (near.triangles.empty()) return conflicts;
  const MeshView<std::int32_t> view{positions, near.triangles};
  auto pairs = intersecting_triangles(view, near.is_suspect, run);
  for (auto& pair : pairs) pair = {near.numbers[pair[0]], near.numbers[pair[1]]};
  for (const auto& fold : folded_pairs(view, 0, near.is_suspect, run)) {
    // Edges between regions are edges of the shape, which may have any angle.
    const std::array<std::uint32_t, 2> pair = {near.numbers[fold[0]], near.numbers[fold[1]]};
    if (labels.empty() || labels[pair[0]] == labels[pair[1]]) pairs.push_back(pair);
  }
  if (pairs.empty()) return conflicts;
  conflicts.is_bad.assign(positions.size(), 0);
  std::vector<std::uint8_t> must_repeat(parts.size(), 0);
  for (const auto& pair : pairs) {
    for (const std::uint32_t t : pair) {
      must_repeat[patches[t]] = 1;
      for (const std::int32_t v : triangles[t]) conflicts.is_bad[as_index(v)] = 1;
    }
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (must_repeat[i] != 0) conflicts.patches.push_back(static_cast<std::int64_t>(i));
  }
  return conflicts;
}

// Freezes the vertices whose removal led to intersections, and simplifies their patches again.
void repair(const FacetedMesh& mesh, const Facets& facets, const PatchDivision& division,
            const SimplifyScale& scale, const Run& run, VertexStates* states,
            std::vector<SimplifiedPatch>* parts) {
  std::vector<std::uint8_t> is_unknown(parts->size(), 1);
  for (int round = 0;; ++round) {
    const double begin = 1.0 - std::ldexp(1.0, -round);
    const Run step = run.part(begin, 1.0 - std::ldexp(1.0, -round - 1));
    const Stages stages(step, {1, 1});
    const Conflicts conflicts =
        find_conflicts(mesh.positions, *parts, is_unknown, cube_side(scale), stages[0]);
    if (conflicts.patches.empty()) return;
    is_unknown.assign(parts->size(), 0);
    for (const std::int64_t patch : conflicts.patches)
      is_unknown[static_cast<std::size_t>(patch)] = 1;
    const auto rerun = [&](std::int64_t i) {
      const auto patch = static_cast<std::size_t>(conflicts.patches[static_cast<std::size_t>(i)]);
      freeze(facets.triangles, division, patch, conflicts.is_bad, round >= kMaxRepairs, states);
      (*parts)[patch] = simplified(mesh, facets, division, patch, scale, states);
    };
    parallel_for(static_cast<std::int64_t>(conflicts.patches.size()), stages[1], rerun);
  }
}

Facets joined(std::vector<SimplifiedPatch>* parts) {
  Facets all;
  std::size_t triangles = 0;
  std::size_t points = 0;
  for (const SimplifiedPatch& part : *parts) {
    triangles += part.facets.triangles.size();
    points += part.facets.points.size();
  }
  all.triangles.reserve(triangles);
  all.point_ends.reserve(triangles);
  all.points.reserve(points);
  for (SimplifiedPatch& part : *parts) {
    append(&part.facets, &all);
    part = {};
  }
  return all;
}

// Runs a pass; returns whether another one is worthwhile. The triangles are in `facets`, not in
// `mesh`.
bool run_pass(int number, const FacetedMesh& mesh, const SimplifyScale& scale,
              std::span<const std::uint8_t> is_open, const Run& run, Facets* facets,
              VertexStates* states) {
  const std::size_t count = facets->triangles.size();
  const Stages stages(run, {1, 7, 2});
  PatchDivision division =
      divide_into_patches(mesh.positions, facets->triangles, number, stages[0]);
  for (std::size_t v = 0; v < is_open.size(); ++v) {
    if (is_open[v] != 0) division.owners[v] = PatchDivision::kShared;
  }
  std::vector<SimplifiedPatch> parts(division.count());
  const auto simplify_patch = [&](std::int64_t i) {
    const auto patch = static_cast<std::size_t>(i);
    parts[patch] = simplified(mesh, *facets, division, patch, scale, states);
  };
  parallel_for(static_cast<std::int64_t>(parts.size()), stages[1], simplify_patch);
  repair(mesh, *facets, division, scale, stages[2], states, &parts);
  *facets = joined(&parts);
  for (std::size_t v = 0; v < division.owners.size(); ++v) {
    if (division.owners[v] >= 0) states->is_waiting[v] = 0;
  }
  const std::size_t removed = count - facets->triangles.size();
  return division.count() > 1 && (number == 0 || static_cast<double>(removed) >=
                                                     kMinRemovedShare * static_cast<double>(count));
}

}  // namespace

SimplifyScale scale_of(std::span<const Vector3> positions,
                       std::span<const std::array<std::int32_t, 3>> triangles, double tolerance) {
  SimplifyScale scale{kMeasuredShare * tolerance, 0.0};
  const std::size_t step = triangles.size() / kMaxMeasuredEdges + 1;
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
                     const Run& run, Facets* facets) {
  VertexStates states(mesh.positions.size(), std::move(fixed.is_kept));
  double begin = 0.0;
  for (int i = 0; i < kMaxPasses; ++i) {
    const double end = begin + 0.6 * (1.0 - begin);
    if (!run_pass(i, mesh, scale, fixed.is_open, run.part(begin, end), facets, &states)) {
      break;
    }
    begin = end;
  }
}

}  // namespace prefilter
