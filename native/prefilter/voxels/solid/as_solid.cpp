// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/as_solid.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/voxels/solid/closed_parts.h"
#include "prefilter/voxels/solid/nesting.h"
#include "prefilter/voxels/solid/open_parts.h"
#include "prefilter/voxels/solid/patches.h"
#include "prefilter/voxels/solid/weld.h"

namespace prefilter {
namespace {

// A part is mixed if more than this share of its area had to be turned to make it consistent.
constexpr double kMixedShare = 0.1;

void check_length(const char* name, double value, bool may_be_zero) {
  if (std::isfinite(value) && (value > 0.0 || (may_be_zero && value == 0.0))) return;
  throw_invalid(std::string(name) + ": " + to_text(value) + "; a finite number " +
                (may_be_zero ? "of 0 or more" : "above 0") + " is needed");
}

void check(const InputMesh& mesh, const SolidOptions& options) {
  check_length("cell", options.cell, false);
  check_length("weld", options.weld, true);
  check_length("gap", options.gap, true);
  check_length("thickness", options.thickness, true);
  check_mesh(mesh, kLargestCoordinate);
}

WorkMesh work_mesh(const InputMesh& mesh) {
  WorkMesh work;
  work.positions.reserve(mesh.positions.size());
  for (const Vector3& position : mesh.positions) work.positions.push_back(position);
  work.triangles.resize(mesh.triangles.size());
  work.origins.resize(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      work.triangles[t][i] = static_cast<std::int32_t>(mesh.triangles[t][i]);
    }
    work.origins[t] = static_cast<std::int64_t>(t);
  }
  return work;
}

// Turns closed patches that are inside out, and returns their number.
std::size_t turn_closed_patches(const Patches& patches, WorkMesh* mesh, const Run& run) {
  std::vector<ClosedPart> parts;
  std::vector<std::uint32_t> part_of_patch(patches.patches.size());
  std::vector<std::size_t> first(patches.patches.size(), mesh->triangles.size());
  for (std::size_t t = mesh->triangles.size(); t-- > 0;) first[patches.patch_of[t]] = t;
  const auto is_part = [](const FacePatch& patch) { return patch.is_closed(); };
  const auto count = static_cast<std::uint32_t>(
      std::count_if(patches.patches.begin(), patches.patches.end(), is_part));
  for (std::size_t p = 0; p < patches.patches.size(); ++p) {
    const FacePatch& patch = patches.patches[p];
    part_of_patch[p] = is_part(patch) ? static_cast<std::uint32_t>(parts.size()) : count;
    if (is_part(patch)) {
      parts.push_back({patch.volume, patch.area, patch.triangles, 0, first[p],
                       patch.turned_area > kMixedShare * patch.area, patch.box});
    }
  }
  std::vector<std::uint32_t> part_of(mesh->triangles.size());
  for (std::size_t t = 0; t < part_of.size(); ++t) {
    part_of[t] = part_of_patch[patches.patch_of[t]];
  }
  const std::vector<bool> is_turned =
      parts_to_turn({mesh->positions, mesh->triangles}, parts, part_of, run);
  for (std::size_t t = 0; t < mesh->triangles.size(); ++t) {
    if (part_of[t] < count && is_turned[part_of[t]]) {
      std::swap(mesh->triangles[t][1], mesh->triangles[t][2]);
    }
  }
  return static_cast<std::size_t>(std::count(is_turned.begin(), is_turned.end(), true));
}

Solid finished(WorkMesh work, const SolidReport& report) {
  Solid solid;
  solid.report = report;
  solid.positions = std::move(work.positions);
  solid.triangles.resize(work.triangles.size());
  for (std::size_t t = 0; t < work.triangles.size(); ++t) {
    std::copy(work.triangles[t].begin(), work.triangles[t].end(), solid.triangles[t].begin());
  }
  solid.origins = std::move(work.origins);
  return solid;
}

}  // namespace

Solid as_solid(const InputMesh& mesh, const SolidOptions& options) {
  check(mesh, options);
  const Run& run = options.run;
  Solid unchanged;
  unchanged.is_unchanged = true;
  const Stages stages(run, {4, 1, 1, 2, 1, 1, 3, 1, 6});
  if (is_solid(mesh, options.cell * options.thickness, stages[0], &unchanged.report.parts)) {
    run.report(1.0);
    return unchanged;
  }

  SolidReport report;
  WorkMesh work = work_mesh(mesh);
  const std::size_t equal = weld_equal(&work, stages[1]);
  report.duplicate_faces = drop_duplicates(&work, stages[2]);
  if (options.weld > 0.0) {
    report.welded_vertices = weld_borders(&work, options.weld * options.cell, stages[3]);
    report.welded_vertices += split_borders(&work, options.weld * options.cell, stages[4]);
    report.duplicate_faces += drop_duplicates(&work, stages[5]);
  }
  Patches patches = find_patches(work.view(), stages[6]);
  report.parts = patches.patches.size();
  report.turned_faces = static_cast<std::size_t>(
      std::count(patches.is_turned.begin(), patches.is_turned.end(), std::uint8_t{1}));
  for (std::size_t t = 0; t < work.triangles.size(); ++t) {
    if (patches.is_turned[t] != 0) std::swap(work.triangles[t][1], work.triangles[t][2]);
  }
  report.turned_parts = turn_closed_patches(patches, &work, stages[7]);
  const bool is_mended = repair_open_parts(patches, options, stages[8], &work, &report);
  run.report(1.0);
  const bool is_other = is_mended || report.welded_vertices + report.duplicate_faces +
                                             report.turned_faces + report.turned_parts >
                                         0;
  // Voxels do not distinguish vertices with equal positions, so welding these is no change.
  if (!is_other) {
    unchanged.report = report;
    return unchanged;
  }
  report.welded_vertices += equal;
  return finished(std::move(work), report);
}

}  // namespace prefilter
