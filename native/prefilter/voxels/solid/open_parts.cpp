// SPDX-License-Identifier: GPL-3.0-or-later

// Applies the least change that preserves each part. The mesh is voxelized with its holes closed,
// in the cells that it will be voxelized in. Parts that leave no contour there are replaced; the
// others are then evaluated again, since the replaced parts' caps are gone.
#include "prefilter/voxels/solid/open_parts.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "prefilter/voxels/close_holes.h"
#include "prefilter/voxels/solid/border_loops.h"
#include "prefilter/voxels/solid/contour_coverage.h"
#include "prefilter/voxels/solid/fill.h"
#include "prefilter/voxels/solid/hollow_regions.h"
#include "prefilter/voxels/solid/loop_caps.h"
#include "prefilter/voxels/solid/part_actions.h"
#include "prefilter/voxels/solid/reach.h"
#include "prefilter/voxels/solid/sheets.h"
#include "prefilter/voxels/solid/shell.h"
#include "prefilter/voxels/solid/triangle_sides.h"
#include "prefilter/voxels/solid/turn_parts.h"
#include "prefilter/voxels/voxelize.h"

namespace prefilter {
namespace {

constexpr int kDecisionRounds = 3;  // each decision changes the voxels that others depend on
// A part counts as closed if the squared length of its border, relative to its area, is below this.
constexpr double kMaxHoleRatio = 0.02;

using Edge = std::array<std::uint32_t, 2>;

bool is_partly_thickened(const PartDecision& part) {
  return part.action == PartAction::kKeepWinding && part.is_thickened;
}

double open_part_area(const std::array<Vector3, 3>& p) {
  return length(cross(p[1] - p[0], p[2] - p[0])) / 2.0;
}

std::vector<double> areas_of(const WorkMesh& mesh) {
  std::vector<double> areas(mesh.triangles.size());
  for (std::size_t t = 0; t < areas.size(); ++t) areas[t] = open_part_area(mesh.corners(t));
  return areas;
}

// Whether a patch is open; small holes in an enclosing patch do not make it so.
bool is_open(const FacePatch& patch, double cell) {
  const bool is_nearly_closed = patch.is_orientable && patch.turned_area == 0.0 &&
                                patch.border * patch.border < kMaxHoleRatio * patch.area &&
                                patch.volume > cell * patch.area;
  return !patch.is_closed() && !is_nearly_closed;
}

// The triangles of the parts that keep their winding, except the parts in `without`.
WorkMesh winding_parts(const WorkMesh& mesh, const Patches& patches,
                       std::span<const PartDecision> decisions,
                       std::span<const std::size_t> without = {}) {
  std::vector<bool> keeps_winding(decisions.size());
  for (std::size_t p = 0; p < decisions.size(); ++p)
    keeps_winding[p] = decisions[p].action == PartAction::kKeepWinding;
  for (const std::size_t p : without) keeps_winding[p] = false;
  WorkMesh result;
  result.positions = mesh.positions;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!keeps_winding[patches.patch_of[t]]) continue;
    result.triangles.push_back(mesh.triangles[t]);
    result.origins.push_back(mesh.origins[t]);
  }
  return result;
}

// Voxelizes a mesh with its holes closed, in a root around all patches.
Octree voxels_of(const WorkMesh& mesh, const Patches& patches, double cell, const Run& run) {
  Box box = kEmptyBox;
  for (const FacePatch& patch : patches.patches) box.include(patch.box);
  Octree octree = empty_tree_around(box, cell);
  bool has_area = false;
  for (std::size_t t = 0; t < mesh.triangles.size() && !has_area; ++t) {
    has_area = open_part_area(mesh.corners(t)) > 0.0;
  }
  if (!has_area) return octree;
  CloseHolesOptions holes;
  holes.method = HoleMethod::kFan;
  // Close sheets too, so that they leave no contour and get thickened.
  holes.leaves_losses = false;
  const Stages stages(run, {3, 7});
  holes.run = stages[0];
  const Caps caps = close_holes({mesh.positions, mesh.triangles}, holes);
  std::vector<Vector3> positions = mesh.positions;
  positions.insert(positions.end(), caps.positions.begin(), caps.positions.end());
  std::vector<std::array<std::int32_t, 3>> triangles = mesh.triangles;
  for (const auto& [a, b, c] : caps.triangles) {
    triangles.push_back(
        {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), static_cast<std::int32_t>(c)});
  }
  VoxelizeOptions options;
  options.depth = octree.depth;
  options.bounds = octree.bounds;
  options.run = stages[1];
  return voxelize({positions, triangles}, options);
}

// Marks the parts around regions that winding numbers leave empty to be filled. Returns flags of
// these regions, by label; empty if there are no such parts.
std::vector<bool> fill_hollow(const Patches& patches, std::span<const double> areas,
                              std::span<const TriangleSides> sides, const ReachGrid& grid,
                              const Octree& octree, int threads,
                              std::span<PartDecision> decisions) {
  std::vector<bool> is_hollow =
      hollow_regions(patches, areas, sides, filled_shares(grid, octree, threads));
  const std::vector<std::size_t> parts = parts_around(patches, areas, sides, is_hollow);
  for (const std::size_t p : parts) decisions[p].action = PartAction::kReplaceByRegion;
  if (parts.empty()) is_hollow.clear();
  return is_hollow;
}

// The triangles that get a shell.
std::vector<std::uint32_t> thin_triangles(const Patches& patches, std::span<const float> coverage,
                                          std::span<const PartDecision> decisions,
                                          float max_coverage) {
  std::vector<std::uint32_t> thin;
  for (std::size_t t = 0; t < coverage.size(); ++t) {
    const auto& [action, is_thickened] = decisions[patches.patch_of[t]];
    const bool is_lost = is_thickened && coverage[t] < max_coverage;
    if (action == PartAction::kReplaceByShell || is_lost)
      thin.push_back(static_cast<std::uint32_t>(t));
  }
  return thin;
}

// Adds each triangle a second time, reversed; closed parts are left alone.
void add_faces(const WorkMesh& mesh, const Patches& patches, std::span<const std::uint32_t> thin,
               WorkMesh* result) {
  for (const std::uint32_t t : thin) {
    if (patches.patches[patches.patch_of[t]].is_closed()) continue;
    const auto& [a, b, c] = mesh.triangles[t];
    result->triangles.push_back({a, b, c});
    result->triangles.push_back({a, c, b});
    result->origins.insert(result->origins.end(), 2, mesh.origins[t]);
  }
}

// Edges of loops that stay open when a mesh's holes are closed, sorted.
std::vector<Edge> open_edges(const WorkMesh& mesh, const Run& run) {
  const InputMesh input{mesh.positions, mesh.triangles};
  const Stages stages(run, {5, 4, 1});
  const BorderLoops loops = border_loops(input, stages[0]);
  std::vector<unsigned char> is_kept(loops.size(), 1);
  const std::vector<LoopCap> caps = first_caps(input, loops, is_kept, HoleMethod::kFlat, stages[1]);
  drop_sheet_loops(input, loops, caps, stages[2], is_kept);
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (is_kept[i] != 0) continue;
    const auto loop = loops.loop(i);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const std::uint32_t next = loop[k + 1 < loop.size() ? k + 1 : 0];
      edges.push_back({std::min(loop[k], next), std::max(loop[k], next)});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// Turns parts into sheets if they are thickened in places and their borders would stay open like a
// sheet's, which leaves their winding number at 1/2. Returns whether there are any.
bool turn_into_sheets(const WorkMesh& mesh, const WorkMesh& result, const Patches& patches,
                      const Run& run, std::span<PartDecision> decisions) {
  if (std::none_of(decisions.begin(), decisions.end(), is_partly_thickened)) return false;
  const std::vector<Edge> edges = open_edges(result, run);
  bool has_changed = false;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::size_t p = patches.patch_of[t];
    if (!is_partly_thickened(decisions[p]) || patches.patches[p].is_closed()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint32_t>(mesh.triangles[t][k]);
      const auto b = static_cast<std::uint32_t>(mesh.triangles[t][(k + 1) % 3]);
      const Edge edge = {std::min(a, b), std::max(a, b)};
      if (!std::binary_search(edges.begin(), edges.end(), edge)) continue;
      decisions[p].action = PartAction::kReplaceByShell;
      has_changed = true;
      break;
    }
  }
  return has_changed;
}

void append(const TriangleMesh& surface, WorkMesh* mesh) {
  const auto first = static_cast<std::int32_t>(mesh->positions.size());
  mesh->positions.insert(mesh->positions.end(), surface.positions.begin(), surface.positions.end());
  for (const auto& [a, b, c] : surface.triangles) {
    mesh->triangles.push_back({first + a, first + b, first + c});
  }
  mesh->origins.resize(mesh->triangles.size(), -1);
}

void count_decisions(std::span<const PartDecision> decisions, SolidReport* report) {
  for (const auto& [action, is_thickened] : decisions) {
    if (action == PartAction::kReplaceByShell || is_thickened) ++report->thickened_parts;
    if (action == PartAction::kReplaceByRegion) ++report->filled_parts;
  }
}

// Counts triangles as covered if both of their sides are inside other parts, such as the back of an
// eye in its socket: there is no contour, but nothing needs to be thickened.
void add_coverage_by_others(const WorkMesh& mesh, const Patches& patches,
                            std::span<const std::size_t> parts,
                            std::span<const PartDecision> decisions, const Octree& octree,
                            double cell, const Run& run, std::span<float> coverage) {
  const WorkMesh others = winding_parts(mesh, patches, decisions, parts);
  if (parts.empty() || others.triangles.empty()) return;
  std::vector<bool> may_be_covered(mesh.triangles.size());
  for (std::size_t t = 0; t < may_be_covered.size(); ++t) {
    may_be_covered[t] = std::binary_search(parts.begin(), parts.end(), patches.patch_of[t]);
  }
  const Stages stages(run, {4, 1});
  const Octree without = voxels_of(others, patches, cell, stages[0]);
  add_covered(mesh.view(), octree, without, may_be_covered, stages[1], coverage);
}

// Decisions on all parts.
struct PartDecisions {
  std::vector<PartDecision> decisions;
  std::vector<float> coverage;  // of the triangles
  std::vector<bool> is_filled;  // by region label; empty: none

  bool keeps_winding() const {
    return std::all_of(decisions.begin(), decisions.end(), [](const PartDecision& part) {
      return part.action == PartAction::kKeepWinding;
    });
  }
};

// `grid` and `sides` are only set if there are open parts.
PartDecisions decide(const WorkMesh& mesh, const Patches& patches, std::span<const double> areas,
                     const ReachGrid* grid, std::span<const TriangleSides> sides,
                     const SolidOptions& options, const Run& run) {
  PartDecisions plan;
  plan.decisions.resize(patches.patches.size());
  for (int round = 0; round < kDecisionRounds; ++round) {
    const Run part = run.part(static_cast<double>(round) / kDecisionRounds,
                              static_cast<double>(round + 1) / kDecisionRounds);
    const WorkMesh winding = winding_parts(mesh, patches, plan.decisions);
    if (winding.triangles.empty()) break;
    const Octree octree = voxels_of(winding, patches, options.cell, part.part(0.0, 0.5));
    const double thickness = options.thickness * options.cell;
    plan.coverage = contour_coverage(mesh.view(), octree, part.part(0.5, 0.6));
    const std::vector<std::size_t> parts = parts_to_cover(
        patches, part_areas(patches, areas, plan.coverage, sides), thickness, plan.decisions);
    add_coverage_by_others(mesh, patches, parts, plan.decisions, octree, options.cell,
                           part.part(0.6, 0.9), plan.coverage);
    bool has_changed = false;
    if (round == 0 && grid != nullptr && options.gap > 0.0) {
      plan.is_filled =
          fill_hollow(patches, areas, sides, *grid, octree, options.run.threads(), plan.decisions);
      has_changed = !plan.is_filled.empty();
    }
    has_changed |= decide_parts(patches, part_areas(patches, areas, plan.coverage, sides),
                                thickness, plan.decisions);
    if (!has_changed) break;
  }
  return plan;
}

}  // namespace

bool repair_open_parts(const Patches& patches, const SolidOptions& options, const Run& run,
                       WorkMesh* mesh, SolidReport* report) {
  const auto& all = patches.patches;
  const double cell = options.cell;
  const double thickness = options.thickness * cell;
  const bool has_open =
      std::any_of(all.begin(), all.end(), [&](const FacePatch& p) { return is_open(p, cell); });
  if (!has_open && std::none_of(all.begin(), all.end(),
                                [&](const FacePatch& p) { return is_thin(p, thickness); })) {
    return false;
  }
  const std::vector<double> areas = areas_of(*mesh);
  std::optional<ReachGrid> grid;
  std::vector<TriangleSides> sides;
  TurnedParts turned;
  const Stages stages(run, {4, 2, 10, 2, 1, 1});
  if (has_open) {
    grid.emplace(mesh->view(), cell, options.gap * cell, stages[0]);
    sides = sides_of_triangles(mesh->view(), *grid, stages[1]);
    turned = turn_open_parts(patches, areas, cell, mesh, sides);
    report->turned_parts += turned.parts;
    report->turned_faces += turned.faces;
  }
  PartDecisions plan =
      decide(*mesh, patches, areas, grid ? &*grid : nullptr, sides, options, stages[2]);
  const auto thin_now = [&] {
    return thin_triangles(patches, plan.coverage, plan.decisions,
                          options.sheets == SheetMethod::kFaces ? 0.5F : 1.0F);
  };
  std::vector<std::uint32_t> thin = thin_now();
  const auto make = [&](const Run& part) {
    WorkMesh result = winding_parts(*mesh, patches, plan.decisions);
    if (!plan.is_filled.empty()) {
      append(filled_regions(mesh->view(), *grid, plan.is_filled, part), &result);
    }
    if (options.sheets == SheetMethod::kFaces) {
      add_faces(*mesh, patches, thin, &result);
    } else {
      add_shell(mesh->view(), mesh->origins, thin, thickness / 2.0, &result);
    }
    return result;
  };
  const bool is_same = thin.empty() && plan.keeps_winding();
  if (!is_same) {
    WorkMesh result = make(stages[3]);
    if (options.sheets == SheetMethod::kFaces &&
        turn_into_sheets(*mesh, result, patches, stages[4], plan.decisions)) {
      thin = thin_now();
      result = make(stages[5]);
    }
    std::swap(*mesh, result);
  }
  count_decisions(plan.decisions, report);
  run.report(1.0);
  return !is_same || turned.any();
}

}  // namespace prefilter
