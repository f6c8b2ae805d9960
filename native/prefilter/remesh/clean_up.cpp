// SPDX-License-Identifier: GPL-3.0-or-later

// Narrow triangles are widened patch by patch, each as far as its own vertices go, and then what is
// left around the borders of patches. The triangles that are new are then looked at for
// intersections: where there are any, the patch is done again without those that they were made of.
#include "prefilter/remesh/clean_up.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/remesh/folds.h"
#include "prefilter/remesh/intersections.h"
#include "prefilter/remesh/patch_editor.h"
#include "prefilter/remesh/triangle_parts.h"

namespace prefilter {
namespace {

constexpr std::int64_t kRowsPerTask = 1 << 15;

using Triangle = std::array<std::int32_t, 3>;
using Flags = std::vector<std::uint8_t>;

// Triangles as they were.
struct Snapshot {
  std::vector<Triangle> triangles;
  std::vector<std::int32_t> labels;  // none where the mesh has none

  void put_back(std::size_t i, std::size_t triangle, FacetedMesh* mesh) const {
    mesh->triangles[triangle] = triangles[i];
    if (!labels.empty()) mesh->labels[triangle] = labels[i];
  }
};

// What is around the borders of patches, before it was edited.
struct Borders {
  TriangleParts parts;
  Snapshot before;

  void undo(std::size_t part, FacetedMesh* mesh) const {
    for (std::size_t k = parts.begins[part]; k < parts.begins[part + 1]; ++k) {
      before.put_back(k, parts.triangles[k], mesh);
    }
  }
};

// The triangles that are there.
struct Left {
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> places;  // among all
  Flags is_changed;
};

EditedMesh edited_mesh(FacetedMesh mesh, double crease_tolerance) {
  EditedMesh edited;
  edited.mesh = std::move(mesh);
  edited.crease_tolerance = crease_tolerance;
  const std::size_t vertices = edited.mesh.positions.size();
  edited.owners.assign(vertices, EditedMesh::kNobody);
  edited.firsts.resize(vertices);
  edited.counts.resize(vertices);
  edited.widths.resize(edited.mesh.triangles.size());
  return edited;
}

// Those with a vertex that is flagged.
std::vector<std::uint32_t> triangles_at(const std::vector<Triangle>& triangles,
                                        const Flags& is_flagged, const Progress& progress,
                                        int threads) {
  const auto count = static_cast<std::int64_t>(triangles.size());
  std::vector<std::vector<std::uint32_t>> found(
      static_cast<std::size_t>(range_count(count, kRowsPerTask)));
  const auto find = [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::uint32_t>& some = found[static_cast<std::size_t>(begin / kRowsPerTask)];
    for (std::int64_t t = begin; t < end; ++t) {
      const auto& [a, b, c] = triangles[static_cast<std::size_t>(t)];
      if (a < 0) continue;  // gone
      if ((is_flagged[static_cast<std::size_t>(a)] | is_flagged[static_cast<std::size_t>(b)] |
           is_flagged[static_cast<std::size_t>(c)]) != 0) {
        some.push_back(static_cast<std::uint32_t>(t));
      }
    }
  };
  parallel_ranges(count, kRowsPerTask, threads, progress, find);
  std::vector<std::uint32_t> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

void flag_corners(const std::vector<Triangle>& triangles, std::span<const std::uint32_t> chosen,
                  Flags* is_flagged) {
  for (const std::uint32_t t : chosen) {
    if (triangles[t][0] < 0) continue;
    for (const std::int32_t v : triangles[t]) (*is_flagged)[static_cast<std::size_t>(v)] = 1;
  }
}

// What is narrow yet, and what is around it two triangles wide. The inner vertices get owners.
Borders find_borders(const std::vector<std::vector<std::uint32_t>>& narrow,
                     const Progress& progress, int threads, EditedMesh* edited) {
  const FacetedMesh& mesh = edited->mesh;
  Flags is_near(mesh.positions.size());
  for (const std::vector<std::uint32_t>& some : narrow) {
    flag_corners(mesh.triangles, some, &is_near);
  }
  const std::vector<std::uint32_t> inner =
      triangles_at(mesh.triangles, is_near, progress.part(0.0, 0.4), threads);
  flag_corners(mesh.triangles, inner, &is_near);
  const std::vector<std::uint32_t> all =
      triangles_at(mesh.triangles, is_near, progress.part(0.4, 0.8), threads);
  Borders borders{parts_by_inner_vertices(mesh.triangles, all, is_near, &edited->firsts), {}};
  for (const std::uint32_t t : borders.parts.triangles) {
    borders.before.triangles.push_back(mesh.triangles[t]);
    if (!mesh.labels.empty()) borders.before.labels.push_back(mesh.labels[t]);
  }
  for (std::size_t i = 0; i < borders.parts.count(); ++i) {
    for (const std::uint32_t t : borders.parts.part(i)) {
      for (const std::int32_t vertex : mesh.triangles[t]) {
        const auto v = static_cast<std::size_t>(vertex);
        edited->owners[v] = is_near[v] != 0 ? static_cast<std::uint32_t>(i) : EditedMesh::kSeveral;
      }
    }
  }
  progress.report(1.0);
  return borders;
}

Borders edit_borders(const std::vector<std::vector<std::uint32_t>>& narrow,
                     const Progress& progress, int threads, EditedMesh* edited) {
  Borders borders = find_borders(narrow, progress.part(0.0, 0.5), threads, edited);
  constexpr std::int64_t kPartsPerTask = 16;
  const auto edit = [&](std::int64_t begin, std::int64_t end) {
    PatchEditor editor(edited);
    for (std::int64_t i = begin; i < end; ++i) {
      editor.edit(static_cast<std::uint32_t>(i), borders.parts.part(static_cast<std::size_t>(i)));
    }
  };
  parallel_ranges(static_cast<std::int64_t>(borders.parts.count()), kPartsPerTask, threads,
                  progress.part(0.5, 1.0), edit);
  return borders;
}

// Returns the triangles of the patch that remain narrow.
std::vector<std::uint32_t> edit_patch(const TriangleParts& patches, std::size_t patch,
                                      EditedMesh* edited) {
  PatchEditor editor(edited);
  editor.edit(static_cast<std::uint32_t>(patch), patches.part(patch));
  return editor.narrow();
}

Left find_left(const std::vector<Triangle>& triangles, const std::vector<Triangle>& original,
               const Progress& progress, int threads) {
  const auto rows = static_cast<std::int64_t>(triangles.size());
  std::vector<std::size_t> begins(static_cast<std::size_t>(range_count(rows, kRowsPerTask)) + 1);
  const auto count = [&](std::int64_t begin, std::int64_t end) {
    std::size_t& some = begins[static_cast<std::size_t>(begin / kRowsPerTask) + 1];
    for (std::int64_t t = begin; t < end; ++t) {
      if (triangles[static_cast<std::size_t>(t)] != kGone) ++some;
    }
  };
  parallel_ranges(rows, kRowsPerTask, threads, progress.part(0.0, 0.3), count);
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  Left left;
  left.triangles.resize(begins.back());
  left.places.resize(begins.back());
  left.is_changed.resize(begins.back());
  const auto fill = [&](std::int64_t begin, std::int64_t end) {
    std::size_t place = begins[static_cast<std::size_t>(begin / kRowsPerTask)];
    for (std::int64_t i = begin; i < end; ++i) {
      const auto t = static_cast<std::size_t>(i);
      if (triangles[t] == kGone) continue;
      left.triangles[place] = triangles[t];
      left.places[place] = static_cast<std::uint32_t>(t);
      left.is_changed[place] = triangles[t] != original[t] ? 1 : 0;
      ++place;
    }
  };
  parallel_ranges(rows, kRowsPerTask, threads, progress.part(0.3, 1.0), fill);
  return left;
}

// Those among the changed ones that intersect others, or fold.
std::vector<std::uint32_t> crossing_triangles(const FacetedMesh& mesh,
                                              const std::vector<Triangle>& original,
                                              const Progress& progress, int threads, Left* left) {
  *left = find_left(mesh.triangles, original, progress.part(0.0, 0.1), threads);
  std::vector<std::uint32_t> crossing;
  for (const auto& pair : intersecting_triangles(
           {mesh.positions, left->triangles}, left->is_changed, progress.part(0.1, 1.0), threads)) {
    for (const std::uint32_t t : pair) {
      if (left->is_changed[t] != 0) crossing.push_back(left->places[t]);
    }
  }
  for (const auto& pair : folded_pairs({mesh.positions, left->triangles}, 0, left->is_changed)) {
    for (const std::uint32_t t : pair) {
      if (left->is_changed[t] != 0) crossing.push_back(left->places[t]);
    }
  }
  return crossing;
}

// A patch as it was: vertices that are gone are its own again.
void restore_patch(const TriangleParts& patches, std::size_t patch, const Snapshot& original,
                   EditedMesh* edited) {
  for (const std::uint32_t t : patches.part(patch)) {
    original.put_back(t, t, &edited->mesh);
    for (const std::int32_t vertex : original.triangles[t]) {
      std::uint32_t& owner = edited->owners[static_cast<std::size_t>(vertex)];
      if (std::atomic_ref(owner).load(std::memory_order_relaxed) == EditedMesh::kNobody) {
        owner = static_cast<std::uint32_t>(patch);
      }
    }
  }
}

// Edits patches with crossing triangles again, with the vertices of these fixed, until there are
// none.
void redo_patches(const TriangleParts& patches, const Snapshot& original, Progress rest,
                  int threads, EditedMesh* edited, std::vector<std::vector<std::uint32_t>>* narrow,
                  Left* left) {
  FacetedMesh& mesh = edited->mesh;
  edited->is_fixed.assign(mesh.positions.size(), 0);
  const std::vector<std::uint32_t> patch_of =
      patches.numbers(mesh.triangles.size(), EditedMesh::kNobody);
  while (true) {
    const std::vector<std::uint32_t> crossing =
        crossing_triangles(mesh, original.triangles, rest.part(0.0, 0.3), threads, left);
    if (crossing.empty()) return;
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
    parallel_for(static_cast<std::int64_t>(patches.count()), threads, rest.part(0.3, 0.5), redo);
    // Steps without end, each shorter than the one before.
    rest = rest.part(0.5, 1.0);
  }
}

// Undoes borders with crossing triangles until none has any.
void undo_borders(const Borders& borders, const std::vector<Triangle>& original, Progress rest,
                  int threads, FacetedMesh* mesh, Left* left) {
  const std::vector<std::uint32_t> border_of =
      borders.parts.numbers(original.size(), EditedMesh::kNobody);
  Flags is_undone(borders.parts.count());
  while (true) {
    const std::vector<std::uint32_t> crossing =
        crossing_triangles(*mesh, original, rest.part(0.0, 0.5), threads, left);
    bool is_any = false;
    for (const std::uint32_t t : crossing) {
      const std::uint32_t border = border_of[t];
      if (border == EditedMesh::kNobody || is_undone[border] != 0) continue;
      is_undone[border] = 1;
      borders.undo(border, mesh);
      is_any = true;
    }
    if (!is_any) return;
    rest = rest.part(0.5, 1.0);
  }
}

// Leaves the triangles that are left, and their vertices.
void drop_gone(Left left, const Progress& progress, int threads, FacetedMesh* result) {
  FacetedMesh& mesh = *result;
  mesh.triangles = std::move(left.triangles);
  if (!mesh.labels.empty()) {
    for (std::size_t i = 0; i < left.places.size(); ++i) {
      mesh.labels[i] = mesh.labels[left.places[i]];
    }
    mesh.labels.resize(left.places.size());
  }
  const auto count = static_cast<std::int64_t>(mesh.triangles.size());
  std::vector<std::int32_t> places(mesh.positions.size(), -1);
  const auto mark = [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t t = begin; t < end; ++t) {
      for (const std::int32_t v : mesh.triangles[static_cast<std::size_t>(t)]) {
        std::atomic_ref place(places[static_cast<std::size_t>(v)]);
        place.store(0, std::memory_order_relaxed);
      }
    }
  };
  parallel_ranges(count, kRowsPerTask, threads, progress.part(0.0, 0.3), mark);
  std::int32_t next = 0;
  for (std::size_t v = 0; v < places.size(); ++v) {
    if (places[v] < 0) continue;
    const auto place = static_cast<std::size_t>(next);
    mesh.positions[place] = mesh.positions[v];
    if (!mesh.kinds.empty()) mesh.kinds[place] = mesh.kinds[v];
    places[v] = next++;
  }
  mesh.positions.resize(static_cast<std::size_t>(next));
  if (!mesh.kinds.empty()) mesh.kinds.resize(static_cast<std::size_t>(next));
  const auto rename = [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t t = begin; t < end; ++t) {
      for (std::int32_t& v : mesh.triangles[static_cast<std::size_t>(t)]) {
        v = places[static_cast<std::size_t>(v)];
      }
    }
  };
  parallel_ranges(count, kRowsPerTask, threads, progress.part(0.6, 1.0), rename);
}
}  // namespace

FacetedMesh clean_up(FacetedMesh mesh, double crease_tolerance, const Progress& progress,
                     int threads) {
  if (mesh.triangles.empty()) return {};
  const Snapshot original = {mesh.triangles, mesh.labels};
  EditedMesh edited = edited_mesh(std::move(mesh), crease_tolerance);
  const TriangleParts patches = parts_along_vertices(
      original.triangles, edited.mesh.positions.size(), progress.part(0.0, 0.06), threads);
  find_owners(patches, original.triangles, progress.part(0.06, 0.1), threads, &edited.owners);
  std::vector<std::vector<std::uint32_t>> narrow(patches.count());
  parallel_for(static_cast<std::int64_t>(patches.count()), threads, progress.part(0.1, 0.5),
               [&](std::int64_t i) {
                 const auto patch = static_cast<std::size_t>(i);
                 narrow[patch] = edit_patch(patches, patch, &edited);
               });
  Borders borders = edit_borders(narrow, progress.part(0.5, 0.6), threads, &edited);
  Left left;
  const Progress mending = progress.part(0.6, 0.9);
  if (!crossing_triangles(edited.mesh, original.triangles, mending, threads, &left).empty()) {
    for (std::size_t i = 0; i < borders.parts.count(); ++i) borders.undo(i, &edited.mesh);
    std::fill(edited.owners.begin(), edited.owners.end(), EditedMesh::kNobody);
    find_owners(patches, original.triangles, mending.part(0.0, 0.1), threads, &edited.owners);
    redo_patches(patches, original, mending.part(0.1, 0.6), threads, &edited, &narrow, &left);
    borders = edit_borders(narrow, mending.part(0.6, 0.7), threads, &edited);
    undo_borders(borders, original.triangles, mending.part(0.7, 1.0), threads, &edited.mesh, &left);
  }
  drop_gone(std::move(left), progress.part(0.9, 1.0), threads, &edited.mesh);
  return std::move(edited.mesh);
}

}  // namespace prefilter
