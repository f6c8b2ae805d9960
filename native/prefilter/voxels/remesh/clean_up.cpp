// SPDX-License-Identifier: GPL-3.0-or-later

// Widens narrow triangles patch by patch, as far as only vertices of one patch are involved, and
// then the remaining ones around the borders of patches. Searches the new triangles for
// intersections; where there are any, the patch is edited again with the vertices of the
// intersecting triangles fixed.
#include "prefilter/voxels/remesh/clean_up.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/base/parallel.h"
#include "prefilter/voxels/remesh/folds.h"
#include "prefilter/voxels/remesh/intersections.h"
#include "prefilter/voxels/remesh/near_intersections.h"
#include "prefilter/voxels/remesh/patch_editor.h"
#include "prefilter/voxels/remesh/triangle_parts.h"

namespace prefilter {
namespace {

constexpr std::int64_t kCleanUpRowsPerTask = 1 << 15;
constexpr float kWedgeSlackRadians = 0.0873F;  // 5 degrees, by which wedges may become sharper

using Triangle = std::array<std::int32_t, 3>;
using Flags = std::vector<std::uint8_t>;

// Copies of triangles and labels before editing.
struct Snapshot {
  std::vector<Triangle> triangles;
  std::vector<std::int32_t> labels;  // empty if the mesh has none

  void restore(std::size_t i, std::size_t triangle, FacetedMesh* mesh) const {
    mesh->triangles[triangle] = triangles[i];
    if (!labels.empty()) mesh->labels[triangle] = labels[i];
  }
};

// Regions around the borders of patches, with their original triangles.
struct EditedBorders {
  TriangleParts parts;
  Snapshot before;

  void undo(std::size_t part, FacetedMesh* mesh) const {
    for (std::size_t k = parts.begins[part]; k < parts.begins[part + 1]; ++k) {
      before.restore(k, parts.triangles[k], mesh);
    }
  }
};

// The triangles that were not removed.
struct RemainingTriangles {
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> old_indices;  // index of each in the original list
};

EditedMesh edited_mesh(FacetedMesh mesh, const CleaningLimits& limits) {
  EditedMesh edited;
  edited.mesh = std::move(mesh);
  edited.crease_tolerance = limits.crease;
  edited.max_height = limits.height;
  const std::size_t vertices = edited.mesh.positions.size();
  edited.owners.assign(vertices, EditedMesh::kUnowned);
  edited.firsts.resize(vertices);
  edited.counts.resize(vertices);
  edited.widths.resize(edited.mesh.triangles.size());
  return edited;
}

// Triangles with a flagged vertex.
std::vector<std::uint32_t> triangles_at(const std::vector<Triangle>& triangles,
                                        const Flags& is_flagged, const Run& run) {
  const auto count = static_cast<std::int64_t>(triangles.size());
  std::vector<std::vector<std::uint32_t>> lists(
      static_cast<std::size_t>(range_count(count, kCleanUpRowsPerTask)));
  const auto find = [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::uint32_t>& some = lists[static_cast<std::size_t>(begin / kCleanUpRowsPerTask)];
    for (std::int64_t t = begin; t < end; ++t) {
      const auto& [a, b, c] = triangles[static_cast<std::size_t>(t)];
      if (a < 0) continue;  // removed
      if ((is_flagged[static_cast<std::size_t>(a)] | is_flagged[static_cast<std::size_t>(b)] |
           is_flagged[static_cast<std::size_t>(c)]) != 0) {
        some.push_back(static_cast<std::uint32_t>(t));
      }
    }
  };
  parallel_ranges(count, kCleanUpRowsPerTask, run, find);
  std::vector<std::uint32_t> all;
  for (const auto& some : lists) all.insert(all.end(), some.begin(), some.end());
  return all;
}

void flag_corners(const std::vector<Triangle>& triangles, std::span<const std::uint32_t> chosen,
                  Flags* is_flagged) {
  for (const std::uint32_t t : chosen) {
    if (triangles[t][0] < 0) continue;
    for (const std::int32_t v : triangles[t]) (*is_flagged)[static_cast<std::size_t>(v)] = 1;
  }
}

// Remaining narrow triangles and their surroundings, two triangles wide. Sets the owners of their
// inner vertices.
EditedBorders find_borders(const std::vector<std::vector<std::uint32_t>>& narrow, const Run& run,
                           EditedMesh* edited) {
  const FacetedMesh& mesh = edited->mesh;
  Flags is_near(mesh.positions.size());
  for (const std::vector<std::uint32_t>& some : narrow) {
    flag_corners(mesh.triangles, some, &is_near);
  }
  const std::vector<std::uint32_t> inner =
      triangles_at(mesh.triangles, is_near, run.part(0.0, 0.4));
  flag_corners(mesh.triangles, inner, &is_near);
  const std::vector<std::uint32_t> all = triangles_at(mesh.triangles, is_near, run.part(0.4, 0.8));
  EditedBorders borders{parts_by_inner_vertices(mesh.triangles, all, is_near, &edited->firsts), {}};
  for (const std::uint32_t t : borders.parts.triangles) {
    borders.before.triangles.push_back(mesh.triangles[t]);
    if (!mesh.labels.empty()) borders.before.labels.push_back(mesh.labels[t]);
  }
  for (std::size_t i = 0; i < borders.parts.count(); ++i) {
    for (const std::uint32_t t : borders.parts.part(i)) {
      for (const std::int32_t vertex : mesh.triangles[t]) {
        const auto v = static_cast<std::size_t>(vertex);
        edited->owners[v] = is_near[v] != 0 ? static_cast<std::uint32_t>(i) : EditedMesh::kShared;
      }
    }
  }
  run.report(1.0);
  return borders;
}

EditedBorders edit_borders(const std::vector<std::vector<std::uint32_t>>& narrow, const Run& run,
                           EditedMesh* edited) {
  const Stages stages(run, {1, 1});
  EditedBorders borders = find_borders(narrow, stages[0], edited);
  constexpr std::int64_t kPartsPerTask = 16;
  const auto edit = [&](std::int64_t begin, std::int64_t end) {
    PatchEditor editor(edited);
    for (std::int64_t i = begin; i < end; ++i) {
      editor.edit(static_cast<std::uint32_t>(i), borders.parts.part(static_cast<std::size_t>(i)));
    }
  };
  parallel_ranges(static_cast<std::int64_t>(borders.parts.count()), kPartsPerTask, stages[1], edit);
  return borders;
}

// Returns the triangles of the patch that remain narrow.
std::vector<std::uint32_t> edit_patch(const TriangleParts& patches, std::size_t patch,
                                      EditedMesh* edited) {
  PatchEditor editor(edited);
  editor.edit(static_cast<std::uint32_t>(patch), patches.part(patch));
  return editor.narrow();
}

RemainingTriangles find_remaining(const std::vector<Triangle>& triangles, const Run& run) {
  const auto rows = static_cast<std::int64_t>(triangles.size());
  std::vector<std::size_t> begins(static_cast<std::size_t>(range_count(rows, kCleanUpRowsPerTask)) +
                                  1);
  const auto count = [&](std::int64_t begin, std::int64_t end) {
    std::size_t& some = begins[static_cast<std::size_t>(begin / kCleanUpRowsPerTask) + 1];
    for (std::int64_t t = begin; t < end; ++t) {
      if (triangles[static_cast<std::size_t>(t)] != kRemoved) ++some;
    }
  };
  const Stages stages(run, {3, 7});
  parallel_ranges(rows, kCleanUpRowsPerTask, stages[0], count);
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  RemainingTriangles left;
  left.triangles.resize(begins.back());
  left.old_indices.resize(begins.back());
  const auto fill = [&](std::int64_t begin, std::int64_t end) {
    std::size_t place = begins[static_cast<std::size_t>(begin / kCleanUpRowsPerTask)];
    for (std::int64_t i = begin; i < end; ++i) {
      const auto t = static_cast<std::size_t>(i);
      if (triangles[t] == kRemoved) continue;
      left.triangles[place] = triangles[t];
      left.old_indices[place] = static_cast<std::uint32_t>(t);
      ++place;
    }
  };
  parallel_ranges(rows, kCleanUpRowsPerTask, stages[1], fill);
  return left;
}

std::vector<std::int32_t> shared_vertices(const Triangle& a, const Triangle& b) {
  std::vector<std::int32_t> shared;
  for (const std::int32_t v : a) {
    if (std::find(b.begin(), b.end(), v) != b.end()) shared.push_back(v);
  }
  return shared;
}

double angle_between(const MeshView<std::int32_t>& mesh,
                     const std::array<std::uint32_t, 2>& triangles) {
  std::array<Vector3, 2> normals;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto [a, b, c] = mesh.corners(triangles[i]);
    normals[i] = cross(b - a, c - a);
  }
  return elementary::atan2(length(cross(normals[0], normals[1])), dot(normals[0], normals[1]));
}

// For vertices on edges of the shape that are as sharp as folds: the largest angle between adjacent
// normals; 0 for all other vertices.
std::vector<float> wedge_turns(const MeshView<std::int32_t>& mesh,
                               const std::vector<VertexKind>& kinds, const Run& run) {
  std::vector<float> turns(mesh.positions.size(), 0.0F);
  if (kinds.empty()) return turns;
  Flags is_suspect(mesh.triangles.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    is_suspect[t] =
        std::count_if(mesh.triangles[t].begin(), mesh.triangles[t].end(), [&](std::int32_t v) {
          return kinds[static_cast<std::size_t>(v)] != VertexKind::kSurface;
        }) > 1;
  }
  for (const auto& pair : folded_pairs(mesh, 0, is_suspect, run)) {
    const auto turn = static_cast<float>(angle_between(mesh, pair));
    for (const std::int32_t v : shared_vertices(mesh.triangles[pair[0]], mesh.triangles[pair[1]])) {
      float& most = turns[static_cast<std::size_t>(v)];
      most = std::max(most, turn);
    }
  }
  return turns;
}

// Finds triangles that intersect others, or fold. Later searches test only triangles that changed
// since the first or the last search, and earlier hits; all other pairs are known to be disjoint.
class CrossingSearch {
 public:
  CrossingSearch(const FacetedMesh& mesh, const std::vector<Triangle>& original, const Run& run)
      : original_(original),
        threads_(run.threads()),
        side_(cube_side({mesh.positions, original})),
        wedge_turns_(wedge_turns({mesh.positions, original}, mesh.kinds, run)) {}

  // Intersecting or folded triangles that differ from the original mesh.
  std::vector<std::uint32_t> find(const FacetedMesh& mesh, const Run& run) {
    Flags is_suspect = changed(first_.empty() ? original_ : last_, mesh.triangles);
    if (first_.empty()) {
      first_ = mesh.triangles;
    } else {
      Flags since_first = changed(first_, mesh.triangles);
      const auto count = [](const Flags& flags) {
        return std::accumulate(flags.begin(), flags.end(), std::size_t{0});
      };
      if (count(since_first) < count(is_suspect)) is_suspect = std::move(since_first);
    }
    last_ = mesh.triangles;
    for (const std::uint32_t t : found_) is_suspect[t] = 1;
    const std::vector<std::uint32_t> crossing = find_among(mesh, is_suspect, run);
    found_.insert(found_.end(), crossing.begin(), crossing.end());
    return crossing;
  }

 private:
  // Twice the mean size of a triangle.
  static double cube_side(const MeshView<std::int32_t>& mesh) {
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      Box box = kEmptyBox;
      for (const Vector3& corner : mesh.corners(t)) box.include(corner);
      sum += std::max({box.size(0), box.size(1), box.size(2)});
    }
    return std::max(2.0 * sum / static_cast<double>(mesh.triangles.size()),
                    std::numeric_limits<double>::min());
  }

  static Flags changed(const std::vector<Triangle>& before, const std::vector<Triangle>& now) {
    Flags is_changed(now.size());
    for (std::size_t t = 0; t < now.size(); ++t) is_changed[t] = now[t] != before[t] ? 1 : 0;
    return is_changed;
  }

  std::vector<std::uint32_t> find_among(const FacetedMesh& mesh, const Flags& is_suspect,
                                        const Run& run) const {
    const MeshView<std::int32_t> all{mesh.positions, mesh.triangles};
    const NearTriangles near =
        near_triangles(all, 0, keep_rough_suspects(all, 0, is_suspect, side_, run), side_, run);
    std::vector<std::uint32_t> crossing;
    const auto add = [&](const std::vector<std::array<std::uint32_t, 2>>& pairs) {
      for (const auto& pair : pairs) {
        for (const std::uint32_t i : pair) {
          const std::uint32_t t = near.numbers[i];
          if (mesh.triangles[t] != original_[t]) crossing.push_back(t);
        }
      }
    };
    const MeshView<std::int32_t> view{mesh.positions, near.triangles};
    add(intersecting_triangles(view, near.is_suspect, run));
    std::vector<std::array<std::uint32_t, 2>> folds = folded_pairs(view, 0, near.is_suspect, run);
    std::erase_if(folds, [&](const auto& pair) {
      const std::vector<std::int32_t> side =
          shared_vertices(view.triangles[pair[0]], view.triangles[pair[1]]);
      const auto turn = static_cast<float>(angle_between(view, pair)) - kWedgeSlackRadians;
      return std::all_of(side.begin(), side.end(), [&](std::int32_t v) {
        return turn <= wedge_turns_[static_cast<std::size_t>(v)];
      });
    });
    add(folds);
    return crossing;
  }

  const std::vector<Triangle>& original_;
  int threads_;
  double side_;
  std::vector<float> wedge_turns_;
  std::vector<Triangle> first_;
  std::vector<Triangle> last_;
  std::vector<std::uint32_t> found_;
};

// Restores a patch; removed vertices become its own again.
void restore_patch(const TriangleParts& patches, std::size_t patch, const Snapshot& original,
                   EditedMesh* edited) {
  for (const std::uint32_t t : patches.part(patch)) {
    original.restore(t, t, &edited->mesh);
    for (const std::int32_t vertex : original.triangles[t]) {
      std::uint32_t& owner = edited->owners[static_cast<std::size_t>(vertex)];
      if (std::atomic_ref(owner).load(std::memory_order_relaxed) == EditedMesh::kUnowned) {
        owner = static_cast<std::uint32_t>(patch);
      }
    }
  }
}

// Edits patches with intersecting triangles again, with the vertices of these fixed, until there
// are none.
void edit_again(const TriangleParts& patches, const Snapshot& original,
                std::vector<std::uint32_t> crossing, Run remaining, CrossingSearch* search,
                EditedMesh* edited, std::vector<std::vector<std::uint32_t>>* narrow) {
  const FacetedMesh& mesh = edited->mesh;
  edited->is_fixed.assign(mesh.positions.size(), 0);
  const std::vector<std::uint32_t> patch_of =
      patches.part_numbers(mesh.triangles.size(), EditedMesh::kUnowned);
  while (!crossing.empty()) {
    flag_corners(mesh.triangles, crossing, &edited->is_fixed);
    flag_corners(original.triangles, crossing, &edited->is_fixed);
    Flags is_due(patches.count());
    for (const std::uint32_t t : crossing) is_due[patch_of[t]] = 1;
    const auto redo = [&](std::int64_t i) {
      const auto patch = static_cast<std::size_t>(i);
      if (is_due[patch] == 0) return;
      restore_patch(patches, patch, original, edited);
      (*narrow)[patch] = edit_patch(patches, patch, edited);
    };
    const Stages stages(remaining, {3, 2, 5});
    parallel_for(static_cast<std::int64_t>(patches.count()), stages[0], redo);
    crossing = search->find(mesh, stages[1]);
    // The number of rounds is unknown, so each gets half of the remaining progress.
    remaining = stages[2];
  }
}

// Restores border regions with intersecting triangles until there are none.
void undo_borders(const EditedBorders& borders, Run remaining, CrossingSearch* search,
                  FacetedMesh* mesh) {
  const std::vector<std::uint32_t> border_of =
      borders.parts.part_numbers(mesh->triangles.size(), EditedMesh::kUnowned);
  Flags is_undone(borders.parts.count());
  bool is_any = true;
  while (is_any) {
    is_any = false;
    const Stages stages(remaining, {1, 1});
    for (const std::uint32_t t : search->find(*mesh, stages[0])) {
      const std::uint32_t border = border_of[t];
      if (border == EditedMesh::kUnowned || is_undone[border] != 0) continue;
      is_undone[border] = 1;
      borders.undo(border, mesh);
      is_any = true;
    }
    remaining = stages[1];
  }
}

// Reverts changes that make triangles intersect or fold.
void undo_conflicts(const TriangleParts& patches, const Snapshot& original, EditedBorders borders,
                    const Run& run, EditedMesh* edited,
                    std::vector<std::vector<std::uint32_t>>* narrow) {
  FacetedMesh& mesh = edited->mesh;
  CrossingSearch search(mesh, original.triangles, run);
  const Stages stages(run, {4, 1, 1, 2, 1, 1});
  if (search.find(mesh, stages[0]).empty()) return;
  for (std::size_t i = 0; i < borders.parts.count(); ++i) borders.undo(i, &mesh);
  std::fill(edited->owners.begin(), edited->owners.end(), EditedMesh::kUnowned);
  find_owners(patches, original.triangles, stages[1], &edited->owners);
  std::vector<std::uint32_t> crossing = search.find(mesh, stages[2]);
  edit_again(patches, original, std::move(crossing), stages[3], &search, edited, narrow);
  borders = edit_borders(*narrow, stages[4], edited);
  undo_borders(borders, stages[5], &search, &mesh);
}

// Compacts the remaining triangles and vertices.
void drop_removed(const Run& run, FacetedMesh* result) {
  FacetedMesh& mesh = *result;
  RemainingTriangles left = find_remaining(mesh.triangles, run.part(0.0, 0.2));
  mesh.triangles = std::move(left.triangles);
  if (!mesh.labels.empty()) {
    for (std::size_t i = 0; i < left.old_indices.size(); ++i) {
      mesh.labels[i] = mesh.labels[left.old_indices[i]];
    }
    mesh.labels.resize(left.old_indices.size());
  }
  const auto count = static_cast<std::int64_t>(mesh.triangles.size());
  std::vector<std::int32_t> old_indices(mesh.positions.size(), -1);
  const auto mark = [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t t = begin; t < end; ++t) {
      for (const std::int32_t v : mesh.triangles[static_cast<std::size_t>(t)]) {
        std::atomic_ref place(old_indices[static_cast<std::size_t>(v)]);
        place.store(0, std::memory_order_relaxed);
      }
    }
  };
  parallel_ranges(count, kCleanUpRowsPerTask, run.part(0.2, 0.5), mark);
  std::int32_t next = 0;
  for (std::size_t v = 0; v < old_indices.size(); ++v) {
    if (old_indices[v] < 0) continue;
    const auto place = static_cast<std::size_t>(next);
    mesh.positions[place] = mesh.positions[v];
    if (!mesh.kinds.empty()) mesh.kinds[place] = mesh.kinds[v];
    old_indices[v] = next++;
  }
  mesh.positions.resize(static_cast<std::size_t>(next));
  if (!mesh.kinds.empty()) mesh.kinds.resize(static_cast<std::size_t>(next));
  const auto rename = [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t t = begin; t < end; ++t) {
      for (std::int32_t& v : mesh.triangles[static_cast<std::size_t>(t)]) {
        v = old_indices[static_cast<std::size_t>(v)];
      }
    }
  };
  parallel_ranges(count, kCleanUpRowsPerTask, run.part(0.6, 1.0), rename);
}
}  // namespace

FacetedMesh clean_up(FacetedMesh mesh, const CleaningLimits& limits, const Run& run) {
  if (mesh.triangles.empty()) return {};
  const Snapshot original = {mesh.triangles, mesh.labels};
  EditedMesh edited = edited_mesh(std::move(mesh), limits);
  const Stages stages(run, {3, 2, 20, 5, 15, 5});
  const TriangleParts patches =
      parts_along_vertices(original.triangles, edited.mesh.positions.size(), stages[0]);
  find_owners(patches, original.triangles, stages[1], &edited.owners);
  std::vector<std::vector<std::uint32_t>> narrow(patches.count());
  parallel_for(static_cast<std::int64_t>(patches.count()), stages[2], [&](std::int64_t i) {
    const auto patch = static_cast<std::size_t>(i);
    narrow[patch] = edit_patch(patches, patch, &edited);
  });
  EditedBorders borders = edit_borders(narrow, stages[3], &edited);
  undo_conflicts(patches, original, std::move(borders), stages[4], &edited, &narrow);
  drop_removed(stages[5], &edited.mesh);
  return std::move(edited.mesh);
}

}  // namespace prefilter
