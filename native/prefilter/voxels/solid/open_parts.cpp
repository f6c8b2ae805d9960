// SPDX-License-Identifier: GPL-3.0-or-later

// Each part gets the least that keeps it. What winding numbers make of the mesh, with its holes
// closed, is looked up in the cells that it is going to have; parts that leave no contour there are
// replaced, and the rest is looked at again, since their caps are gone.
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
#include "prefilter/voxels/solid/fill.h"
#include "prefilter/voxels/solid/hollow_regions.h"
#include "prefilter/voxels/solid/kept.h"
#include "prefilter/voxels/solid/loop_caps.h"
#include "prefilter/voxels/solid/part_fates.h"
#include "prefilter/voxels/solid/reach.h"
#include "prefilter/voxels/solid/sheets.h"
#include "prefilter/voxels/solid/shell.h"
#include "prefilter/voxels/solid/triangle_sides.h"
#include "prefilter/voxels/solid/turn_parts.h"
#include "prefilter/voxels/voxelize.h"

namespace prefilter {
namespace {

constexpr int kRounds = 3;
// Of a part that counts as closed: the square of the length of its border over its area.
constexpr double kLargestHole = 0.02;

using Edge = std::array<std::uint32_t, 2>;

bool is_partly_thickened(const PartFate& part) {
  return part.fate == Fate::kWound && part.is_thickened;
}

double area_of(const std::array<Vector3, 3>& p) {
  return length(cross(p[1] - p[0], p[2] - p[0])) / 2.0;
}

std::vector<double> areas_of(const WorkMesh& mesh) {
  std::vector<double> areas(mesh.triangles.size());
  for (std::size_t t = 0; t < areas.size(); ++t) areas[t] = area_of(mesh.corners(t));
  return areas;
}

// Parts with small holes alone are wound around as they are.
bool is_open(const FacePatch& patch, double cell) {
  const bool is_nearly_closed = patch.is_orientable && patch.turned_area == 0.0 &&
                                patch.border * patch.border < kLargestHole * patch.area &&
                                patch.volume > cell * patch.area;
  return !patch.is_closed() && !is_nearly_closed;
}

// The triangles that stay, with what they were among all; without those of some parts.
WorkMesh wound_parts(const WorkMesh& mesh, const Patches& patches, std::span<const PartFate> fates,
                     std::span<const std::size_t> without = {}) {
  std::vector<bool> is_wound(fates.size());
  for (std::size_t p = 0; p < fates.size(); ++p) is_wound[p] = fates[p].fate == Fate::kWound;
  for (const std::size_t p : without) is_wound[p] = false;
  WorkMesh result;
  result.positions = mesh.positions;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!is_wound[patches.patch_of[t]]) continue;
    result.triangles.push_back(mesh.triangles[t]);
    result.origins.push_back(mesh.origins[t]);
  }
  return result;
}

// The occupancies of a mesh, with its holes closed, in cells around all of the patches.
Octree voxels_of(const WorkMesh& mesh, const Patches& patches, double cell,
                 const Progress& progress, int threads) {
  Box box = kEmptyBox;
  for (const FacePatch& patch : patches.patches) box.include(patch.box);
  Octree octree = empty_tree_around(box, cell);
  bool has_area = false;
  for (std::size_t t = 0; t < mesh.triangles.size() && !has_area; ++t) {
    has_area = area_of(mesh.corners(t)) > 0.0;
  }
  if (!has_area) return octree;
  CloseHolesOptions holes;
  holes.method = HoleMethod::kFan;
  // So that sheets are lost, and get a thickness.
  holes.leaves_losses = false;
  holes.progress = progress.part(0.0, 0.3);
  holes.threads = threads;
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
  options.threads = threads;
  options.progress = progress.part(0.3, 1.0);
  return voxelize({positions, triangles}, options);
}

// Lets the parts around regions that winding numbers leave empty be filled. Returns these regions,
// by label; none where no part is.
std::vector<bool> fill_hollow(const Patches& patches, std::span<const double> areas,
                              std::span<const TriangleSides> sides, const ReachGrid& grid,
                              const Octree& octree, int threads, std::span<PartFate> fates) {
  std::vector<bool> is_hollow =
      hollow_regions(patches, areas, sides, filled_shares(grid, octree, threads));
  const std::vector<std::size_t> parts = parts_around(patches, areas, sides, is_hollow);
  for (const std::size_t p : parts) fates[p].fate = Fate::kFilled;
  if (parts.empty()) is_hollow.clear();
  return is_hollow;
}

// The triangles that get a shell.
std::vector<std::uint32_t> thin_triangles(const Patches& patches, std::span<const float> kept,
                                          std::span<const PartFate> fates, float most_kept) {
  std::vector<std::uint32_t> thin;
  for (std::size_t t = 0; t < kept.size(); ++t) {
    const auto& [fate, is_thickened] = fates[patches.patch_of[t]];
    const bool is_lost = is_thickened && kept[t] < most_kept;
    if (fate == Fate::kSheet || is_lost) thin.push_back(static_cast<std::uint32_t>(t));
  }
  return thin;
}

// Both sides of triangles, but for those of closed parts, which have them.
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

// The edges of loops that stay open where a mesh's holes are closed, in order.
std::vector<Edge> open_edges(const WorkMesh& mesh, const Progress& progress, int threads) {
  const InputMesh input{mesh.positions, mesh.triangles};
  const BorderLoops loops = border_loops(input, progress.part(0.0, 0.5), threads);
  std::vector<unsigned char> is_kept(loops.size(), 1);
  const std::vector<LoopCap> caps =
      first_caps(input, loops, is_kept, HoleMethod::kFlat, progress.part(0.5, 0.9), threads);
  leave_sheets(input, loops, caps, progress.part(0.9, 1.0), is_kept);
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

// Lets parts be sheets as a whole that are thickened in places, and whose borders stay open then,
// as those of sheets do: winding numbers have them half inside. Returns whether there are any.
bool become_sheets(const WorkMesh& mesh, const WorkMesh& result, const Patches& patches,
                   const Progress& progress, int threads, std::span<PartFate> fates) {
  if (std::none_of(fates.begin(), fates.end(), is_partly_thickened)) return false;
  const std::vector<Edge> edges = open_edges(result, progress, threads);
  bool has_changed = false;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::size_t p = patches.patch_of[t];
    if (!is_partly_thickened(fates[p]) || patches.patches[p].is_closed()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint32_t>(mesh.triangles[t][k]);
      const auto b = static_cast<std::uint32_t>(mesh.triangles[t][(k + 1) % 3]);
      const Edge edge = {std::min(a, b), std::max(a, b)};
      if (!std::binary_search(edges.begin(), edges.end(), edge)) continue;
      fates[p].fate = Fate::kSheet;
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

void count_fates(std::span<const PartFate> fates, SolidReport* report) {
  for (const auto& [fate, is_thickened] : fates) {
    if (fate == Fate::kSheet || is_thickened) ++report->thickened_parts;
    if (fate == Fate::kFilled) ++report->filled_parts;
  }
}

// An eye in its socket: the back of an open part is inside of others, where there is no contour,
// and nothing to be thickened.
void keep_covered(const WorkMesh& mesh, const Patches& patches, std::span<const std::size_t> parts,
                  std::span<const PartFate> fates, const Octree& octree, double cell,
                  const Progress& progress, int threads, std::span<float> kept) {
  const WorkMesh others = wound_parts(mesh, patches, fates, parts);
  if (parts.empty() || others.triangles.empty()) return;
  std::vector<bool> may_be_covered(mesh.triangles.size());
  for (std::size_t t = 0; t < may_be_covered.size(); ++t) {
    may_be_covered[t] = std::binary_search(parts.begin(), parts.end(), patches.patch_of[t]);
  }
  const Octree without = voxels_of(others, patches, cell, progress.part(0.0, 0.8), threads);
  add_covered(mesh.view(), octree, without, may_be_covered, progress.part(0.8, 1.0), threads, kept);
}

// What becomes of the parts, and what of their triangles is kept in the cells.
struct Verdict {
  std::vector<PartFate> fates;
  std::vector<float> kept;      // shares of the triangles
  std::vector<bool> is_filled;  // of the regions, by label; none where no part is

  bool is_wound() const {
    return std::all_of(fates.begin(), fates.end(),
                       [](const PartFate& part) { return part.fate == Fate::kWound; });
  }
};

// `grid` and `sides` are there only where parts are open.
Verdict judge(const WorkMesh& mesh, const Patches& patches, std::span<const double> areas,
              const ReachGrid* grid, std::span<const TriangleSides> sides,
              const SolidOptions& options, const Progress& progress) {
  Verdict verdict;
  verdict.fates.resize(patches.patches.size());
  for (int round = 0; round < kRounds; ++round) {
    const Progress part = progress.part(static_cast<double>(round) / kRounds,
                                        static_cast<double>(round + 1) / kRounds);
    const WorkMesh wound = wound_parts(mesh, patches, verdict.fates);
    if (wound.triangles.empty()) break;
    const Octree octree =
        voxels_of(wound, patches, options.cell, part.part(0.0, 0.5), options.threads);
    const double thickness = options.thickness * options.cell;
    verdict.kept = kept_shares(mesh.view(), octree, part.part(0.5, 0.6), options.threads);
    const std::vector<std::size_t> parts = parts_to_cover(
        patches, part_areas(patches, areas, verdict.kept, sides), thickness, verdict.fates);
    keep_covered(mesh, patches, parts, verdict.fates, octree, options.cell, part.part(0.6, 0.9),
                 options.threads, verdict.kept);
    bool has_changed = false;
    if (round == 0 && grid != nullptr && options.gap > 0.0) {
      verdict.is_filled =
          fill_hollow(patches, areas, sides, *grid, octree, options.threads, verdict.fates);
      has_changed = !verdict.is_filled.empty();
    }
    has_changed |= judge_parts(patches, part_areas(patches, areas, verdict.kept, sides), thickness,
                               verdict.fates);
    if (!has_changed) break;
  }
  return verdict;
}

}  // namespace

bool mend_open_parts(const Patches& patches, const SolidOptions& options, const Progress& progress,
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
  if (has_open) {
    grid.emplace(mesh->view(), cell, options.gap * cell, progress.part(0.0, 0.2), options.threads);
    sides = sides_of_triangles(mesh->view(), *grid, progress.part(0.2, 0.3), options.threads);
    turned = turn_open_parts(patches, areas, cell, mesh, sides);
    report->turned_parts += turned.parts;
    report->turned_faces += turned.faces;
  }
  Verdict verdict = judge(*mesh, patches, areas, grid ? &*grid : nullptr, sides, options,
                          progress.part(0.3, 0.8));
  const auto thin_now = [&] {
    return thin_triangles(patches, verdict.kept, verdict.fates,
                          options.sheets == SheetMethod::kFaces ? 0.5F : 1.0F);
  };
  std::vector<std::uint32_t> thin = thin_now();
  const auto make = [&](const Progress& part) {
    WorkMesh result = wound_parts(*mesh, patches, verdict.fates);
    if (!verdict.is_filled.empty()) {
      append(filled_regions(mesh->view(), *grid, verdict.is_filled, part, options.threads),
             &result);
    }
    if (options.sheets == SheetMethod::kFaces) {
      add_faces(*mesh, patches, thin, &result);
    } else {
      add_shell(mesh->view(), mesh->origins, thin, thickness / 2.0, &result);
    }
    return result;
  };
  const bool is_same = thin.empty() && verdict.is_wound();
  if (!is_same) {
    WorkMesh result = make(progress.part(0.8, 0.9));
    if (options.sheets == SheetMethod::kFaces &&
        become_sheets(*mesh, result, patches, progress.part(0.9, 0.95), options.threads,
                      verdict.fates)) {
      thin = thin_now();
      result = make(progress.part(0.95, 1.0));
    }
    std::swap(*mesh, result);
  }
  count_fates(verdict.fates, report);
  progress.report(1.0);
  return !is_same || turned.any();
}

}  // namespace prefilter
