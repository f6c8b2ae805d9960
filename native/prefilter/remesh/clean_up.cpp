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
#include "prefilter/base/pulse.h"
#include "prefilter/remesh/intersections.h"
#include "prefilter/remesh/patch_editor.h"

namespace prefilter {
namespace {

constexpr std::int64_t kRowsPerTask = 1 << 15;
// Vertices of a patch, unless there would be too many of them.
constexpr int kPatchBits = 14;
constexpr std::size_t kMostPatches = 1 << 10;

using Triangle = std::array<std::int32_t, 3>;

// Lists of triangles, one behind the other.
struct Parts {
  std::vector<std::uint32_t> triangles;
  std::vector<std::size_t> begins = {0};  // and the end

  std::size_t count() const { return begins.size() - 1; }
  std::span<const std::uint32_t> part(std::size_t i) const {
    return std::span(triangles).subspan(begins[i], begins[i + 1] - begins[i]);
  }
};

class Cleaner {
 public:
  Cleaner(FacetedMesh mesh, double crease_tolerance, int threads)
      : original_(mesh.triangles), original_labels_(mesh.labels), threads_(threads) {
    edited_.mesh = std::move(mesh);
    edited_.crease_tolerance = crease_tolerance;
    const std::size_t vertices = edited_.mesh.positions.size();
    edited_.owners.assign(vertices, EditedMesh::kNobody);
    edited_.firsts.resize(vertices);
    edited_.counts.resize(vertices);
    edited_.widths.resize(original_.size());
  }

  FacetedMesh clean(const Progress& progress) {
    find_patches(progress.part(0.0, 0.1));
    edit_patches(progress.part(0.1, 0.5));
    edit_borders(progress.part(0.5, 0.6));
    if (!crossing_triangles(progress.part(0.6, 0.9)).empty()) mend(progress.part(0.6, 0.9));
    drop_gone(progress.part(0.9, 1.0));
    return std::move(edited_.mesh);
  }

 private:
  std::vector<Triangle>& triangles() { return edited_.mesh.triangles; }
  std::int64_t triangle_count() const { return static_cast<std::int64_t>(original_.size()); }
  bool is_changed(std::size_t triangle) const {
    return edited_.mesh.triangles[triangle] != original_[triangle];
  }

  // Vertices that follow each other are near each other, as far as the mesh comes from a contour,
  // and a triangle goes with its first one.
  void find_patches(const Progress& progress) {
    int bits = kPatchBits;
    while ((edited_.mesh.positions.size() >> bits) >= kMostPatches) ++bits;
    const std::size_t patches = (edited_.mesh.positions.size() >> bits) + 1;
    const auto patch_of = [&](std::size_t t) {
      const Triangle& triangle = original_[t];
      return static_cast<std::size_t>(std::min({triangle[0], triangle[1], triangle[2]})) >> bits;
    };
    // Where the triangles of a task begin in their patches.
    const std::int64_t rows_per_task =
        std::max(kRowsPerTask, triangle_count() / static_cast<std::int64_t>(kMostPatches));
    const auto tasks = static_cast<std::size_t>(range_count(triangle_count(), rows_per_task));
    std::vector<std::size_t> places(tasks * patches);
    const auto count = [&](std::int64_t begin, std::int64_t end) {
      std::size_t* const counts =
          &places[static_cast<std::size_t>(begin / rows_per_task) * patches];
      for (std::int64_t t = begin; t < end; ++t) ++counts[patch_of(static_cast<std::size_t>(t))];
    };
    parallel_ranges(triangle_count(), rows_per_task, threads_, progress.part(0.0, 0.3), count);
    std::size_t next = 0;
    for (std::size_t patch = 0; patch < patches; ++patch) {
      for (std::size_t task = 0; task < tasks; ++task) {
        next += std::exchange(places[task * patches + patch], next);
      }
      patches_.begins.push_back(next);
    }
    patches_.triangles.resize(original_.size());
    const auto place = [&](std::int64_t begin, std::int64_t end) {
      std::size_t* const nexts = &places[static_cast<std::size_t>(begin / rows_per_task) * patches];
      for (std::int64_t t = begin; t < end; ++t) {
        patches_.triangles[nexts[patch_of(static_cast<std::size_t>(t))]++] =
            static_cast<std::uint32_t>(t);
      }
    };
    parallel_ranges(triangle_count(), rows_per_task, threads_, progress.part(0.3, 0.6), place);
    find_owners(progress.part(0.6, 1.0));
  }

  void find_owners(const Progress& progress) {
    const auto find = [&](std::int64_t i) {
      const auto patch = static_cast<std::uint32_t>(i);
      for (const std::uint32_t t : patches_.part(patch)) {
        for (const std::int32_t vertex : original_[t]) {
          std::atomic_ref<std::uint32_t> owner(edited_.owners[static_cast<std::size_t>(vertex)]);
          std::uint32_t found = owner.load(std::memory_order_relaxed);
          if (found == patch) continue;
          if (found == EditedMesh::kNobody &&
              owner.compare_exchange_strong(found, patch, std::memory_order_relaxed)) {
            continue;
          }
          if (found != patch) owner.store(EditedMesh::kSeveral, std::memory_order_relaxed);
        }
      }
    };
    parallel_for(static_cast<std::int64_t>(patches_.count()), threads_, progress, find);
  }

  void edit_patches(const Progress& progress) {
    narrow_.resize(patches_.count());
    const auto edit = [&](std::int64_t patch) { edit_patch(static_cast<std::size_t>(patch)); };
    parallel_for(static_cast<std::int64_t>(patches_.count()), threads_, progress, edit);
  }

  void edit_patch(std::size_t patch) {
    PatchEditor editor(&edited_);
    editor.edit(static_cast<std::uint32_t>(patch), patches_.part(patch));
    narrow_[patch] = editor.narrow();
  }

  // What is narrow yet, and what is around it two triangles wide, in parts that have no vertex of
  // the inner ones in common.
  void find_borders(const Progress& progress) {
    std::vector<std::uint8_t> is_near(edited_.mesh.positions.size());
    for (const auto& narrow : narrow_) {
      for (const std::uint32_t t : narrow) {
        if (edited_.is_gone(t)) continue;
        for (const std::int32_t v : triangles()[t]) is_near[static_cast<std::size_t>(v)] = 1;
      }
    }
    const std::vector<std::uint32_t> inner = triangles_at(is_near, progress.part(0.0, 0.4));
    for (const std::uint32_t t : inner) {
      for (const std::int32_t v : triangles()[t]) is_near[static_cast<std::size_t>(v)] = 1;
    }
    const std::vector<std::uint32_t> all = triangles_at(is_near, progress.part(0.4, 0.8));
    // Each inner vertex to one of lower number in its part, in `firsts`.
    std::vector<std::uint32_t>& parents = edited_.firsts;
    for (const std::uint32_t t : all) {
      for (const std::int32_t v : triangles()[t]) {
        parents[static_cast<std::size_t>(v)] = static_cast<std::uint32_t>(v);
      }
    }
    const auto root_of = [&](std::uint32_t v) {
      while (parents[v] != v) v = parents[v] = parents[parents[v]];
      return v;
    };
    const auto inner_of = [&](std::uint32_t t) {
      for (const std::int32_t v : triangles()[t]) {
        if (is_near[static_cast<std::size_t>(v)] != 0) return static_cast<std::uint32_t>(v);
      }
      return EditedMesh::kNobody;
    };
    for (const std::uint32_t t : all) {
      const std::uint32_t first = root_of(inner_of(t));
      std::uint32_t root = first;
      for (const std::int32_t v : triangles()[t]) {
        if (is_near[static_cast<std::size_t>(v)] == 0) continue;
        const std::uint32_t other = root_of(static_cast<std::uint32_t>(v));
        parents[std::max(root, other)] = std::min(root, other);
        root = std::min(root, other);
      }
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> rooted;
    rooted.reserve(all.size());
    for (const std::uint32_t t : all) rooted.push_back({root_of(inner_of(t)), t});
    std::sort(rooted.begin(), rooted.end());
    borders_ = Parts();
    for (std::size_t i = 0; i < rooted.size(); ++i) {
      if (i > 0 && rooted[i].first != rooted[i - 1].first) borders_.begins.push_back(i);
      borders_.triangles.push_back(rooted[i].second);
    }
    if (!rooted.empty()) borders_.begins.push_back(rooted.size());
    before_borders_.clear();
    labels_before_borders_.clear();
    for (const std::uint32_t t : borders_.triangles) {
      before_borders_.push_back(triangles()[t]);
      if (!original_labels_.empty()) labels_before_borders_.push_back(edited_.mesh.labels[t]);
    }
    for (std::size_t i = 0; i < borders_.count(); ++i) {
      for (const std::uint32_t t : borders_.part(i)) {
        for (const std::int32_t vertex : triangles()[t]) {
          const auto v = static_cast<std::size_t>(vertex);
          edited_.owners[v] =
              is_near[v] != 0 ? static_cast<std::uint32_t>(i) : EditedMesh::kSeveral;
        }
      }
    }
    progress.report(1.0);
  }

  // Those with a vertex that is flagged.
  std::vector<std::uint32_t> triangles_at(const std::vector<std::uint8_t>& is_flagged,
                                          const Progress& progress) {
    std::vector<std::vector<std::uint32_t>> found(
        static_cast<std::size_t>(range_count(triangle_count(), kRowsPerTask)));
    const auto find = [&](std::int64_t begin, std::int64_t end) {
      std::vector<std::uint32_t>& some = found[static_cast<std::size_t>(begin / kRowsPerTask)];
      for (std::int64_t i = begin; i < end; ++i) {
        const auto t = static_cast<std::size_t>(i);
        if (edited_.is_gone(t)) continue;
        const auto& [a, b, c] = triangles()[t];
        if ((is_flagged[static_cast<std::size_t>(a)] | is_flagged[static_cast<std::size_t>(b)] |
             is_flagged[static_cast<std::size_t>(c)]) != 0) {
          some.push_back(static_cast<std::uint32_t>(t));
        }
      }
    };
    parallel_ranges(triangle_count(), kRowsPerTask, threads_, progress, find);
    std::vector<std::uint32_t> all;
    for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
    return all;
  }

  void edit_borders(const Progress& progress) {
    find_borders(progress.part(0.0, 0.5));
    constexpr std::int64_t kPartsPerTask = 16;
    const auto edit = [&](std::int64_t begin, std::int64_t end) {
      PatchEditor editor(&edited_);
      for (std::int64_t i = begin; i < end; ++i) {
        editor.edit(static_cast<std::uint32_t>(i), borders_.part(static_cast<std::size_t>(i)));
      }
    };
    parallel_ranges(static_cast<std::int64_t>(borders_.count()), kPartsPerTask, threads_,
                    progress.part(0.5, 1.0), edit);
  }

  // The triangles that are left, and where they are among all.
  void find_left(const Progress& progress) {
    const auto tasks = static_cast<std::size_t>(range_count(triangle_count(), kRowsPerTask));
    std::vector<std::size_t> begins(tasks + 1);
    const auto count = [&](std::int64_t begin, std::int64_t end) {
      std::size_t& some = begins[static_cast<std::size_t>(begin / kRowsPerTask) + 1];
      for (std::int64_t t = begin; t < end; ++t) {
        if (!edited_.is_gone(static_cast<std::size_t>(t))) ++some;
      }
    };
    parallel_ranges(triangle_count(), kRowsPerTask, threads_, progress.part(0.0, 0.3), count);
    std::partial_sum(begins.begin(), begins.end(), begins.begin());
    left_.resize(begins.back());
    left_places_.resize(begins.back());
    is_suspect_.resize(begins.back());
    const auto fill = [&](std::int64_t begin, std::int64_t end) {
      std::size_t place = begins[static_cast<std::size_t>(begin / kRowsPerTask)];
      for (std::int64_t i = begin; i < end; ++i) {
        const auto t = static_cast<std::size_t>(i);
        if (edited_.is_gone(t)) continue;
        left_[place] = triangles()[t];
        left_places_[place] = static_cast<std::uint32_t>(t);
        is_suspect_[place] = is_changed(t) ? 1 : 0;
        ++place;
      }
    };
    parallel_ranges(triangle_count(), kRowsPerTask, threads_, progress.part(0.3, 1.0), fill);
  }

  // Those among the changed ones that intersect others.
  std::vector<std::uint32_t> crossing_triangles(const Progress& progress) {
    find_left(progress.part(0.0, 0.1));
    std::vector<std::uint32_t> crossing;
    for (const auto& pair : intersecting_triangles({edited_.mesh.positions, left_}, is_suspect_,
                                                   progress.part(0.1, 1.0), threads_)) {
      for (const std::uint32_t t : pair) {
        if (is_suspect_[t] != 0) crossing.push_back(left_places_[t]);
      }
    }
    return crossing;
  }

  void mend(const Progress& progress) {
    undo_borders([](std::size_t) { return true; });
    std::fill(edited_.owners.begin(), edited_.owners.end(), EditedMesh::kNobody);
    find_owners(progress.part(0.0, 0.1));
    edited_.is_fixed.assign(edited_.mesh.positions.size(), 0);
    std::vector<std::uint32_t> patch_of(original_.size());
    for (std::size_t i = 0; i < patches_.count(); ++i) {
      for (const std::uint32_t t : patches_.part(i)) patch_of[t] = static_cast<std::uint32_t>(i);
    }
    // Steps without end, each shorter than the one before.
    Progress rest = progress.part(0.1, 0.6);
    while (true) {
      const std::vector<std::uint32_t> crossing = crossing_triangles(rest.part(0.0, 0.3));
      if (crossing.empty()) break;
      std::vector<std::uint8_t> is_due(patches_.count());
      for (const std::uint32_t t : crossing) {
        for (const Triangle* triangle : {&triangles()[t], &original_[t]}) {
          for (const std::int32_t v : *triangle) {
            edited_.is_fixed[static_cast<std::size_t>(v)] = 1;
          }
        }
        is_due[patch_of[t]] = 1;
      }
      const auto redo = [&](std::int64_t i) {
        const auto patch = static_cast<std::size_t>(i);
        if (is_due[patch] == 0) return;
        for (const std::uint32_t t : patches_.part(patch)) {
          triangles()[t] = original_[t];
          if (!original_labels_.empty()) edited_.mesh.labels[t] = original_labels_[t];
        }
        restore_owners(patch);
        edit_patch(patch);
      };
      parallel_for(static_cast<std::int64_t>(patches_.count()), threads_, rest.part(0.3, 0.5),
                   redo);
      rest = rest.part(0.5, 1.0);
    }
    edit_borders(progress.part(0.6, 0.7));
    std::vector<std::uint32_t> border_of(original_.size(), EditedMesh::kNobody);
    for (std::size_t i = 0; i < borders_.count(); ++i) {
      for (const std::uint32_t t : borders_.part(i)) border_of[t] = static_cast<std::uint32_t>(i);
    }
    std::vector<std::uint8_t> is_undone(borders_.count());
    rest = progress.part(0.7, 1.0);
    while (true) {
      const std::vector<std::uint32_t> crossing = crossing_triangles(rest.part(0.0, 0.5));
      std::vector<std::uint8_t> is_due(borders_.count());
      bool is_any = false;
      for (const std::uint32_t t : crossing) {
        const std::uint32_t border = border_of[t];
        if (border == EditedMesh::kNobody || is_undone[border] != 0) continue;
        is_due[border] = 1;
        is_undone[border] = 1;
        is_any = true;
      }
      if (!is_any) break;
      undo_borders([&](std::size_t border) { return is_due[border] != 0; });
      rest = rest.part(0.5, 1.0);
    }
  }

  // Vertices of the patch that are gone are its own again.
  void restore_owners(std::size_t patch) {
    for (const std::uint32_t t : patches_.part(patch)) {
      for (const std::int32_t vertex : original_[t]) {
        std::uint32_t& owner = edited_.owners[static_cast<std::size_t>(vertex)];
        if (std::atomic_ref(owner).load(std::memory_order_relaxed) == EditedMesh::kNobody) {
          owner = static_cast<std::uint32_t>(patch);
        }
      }
    }
  }

  template <typename IsDue>
  void undo_borders(const IsDue& is_due) {
    for (std::size_t i = 0; i < borders_.count(); ++i) {
      if (!is_due(i)) continue;
      for (std::size_t k = borders_.begins[i]; k < borders_.begins[i + 1]; ++k) {
        const std::uint32_t t = borders_.triangles[k];
        triangles()[t] = before_borders_[k];
        if (!original_labels_.empty()) edited_.mesh.labels[t] = labels_before_borders_[k];
      }
    }
  }

  // What was left when it was last looked at is the result.
  void drop_gone(const Progress& progress) {
    FacetedMesh& mesh = edited_.mesh;
    mesh.triangles = std::move(left_);
    if (!mesh.labels.empty()) {
      for (std::size_t i = 0; i < left_places_.size(); ++i) {
        mesh.labels[i] = mesh.labels[left_places_[i]];
      }
      mesh.labels.resize(left_places_.size());
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
    parallel_ranges(count, kRowsPerTask, threads_, progress.part(0.0, 0.3), mark);
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
    parallel_ranges(count, kRowsPerTask, threads_, progress.part(0.6, 1.0), rename);
  }

  EditedMesh edited_;
  std::vector<Triangle> original_;
  std::vector<std::int32_t> original_labels_;
  int threads_;
  Parts patches_;
  std::vector<std::vector<std::uint32_t>> narrow_;  // of each patch
  Parts borders_;
  std::vector<Triangle> before_borders_;
  std::vector<std::int32_t> labels_before_borders_;
  std::vector<Triangle> left_;
  std::vector<std::uint32_t> left_places_;
  std::vector<std::uint8_t> is_suspect_;
};
}  // namespace

FacetedMesh clean_up(FacetedMesh mesh, double crease_tolerance, const Progress& progress,
                     int threads) {
  if (mesh.triangles.empty()) return {};
  return Cleaner(std::move(mesh), crease_tolerance, threads).clean(progress);
}

}  // namespace prefilter
