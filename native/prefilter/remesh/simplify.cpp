// SPDX-License-Identifier: GPL-3.0-or-later

// In passes: each divides the mesh into patches of neighbouring triangles, which are simplified by
// themselves, and each divides it elsewhere, so that the vertices that patches share get their
// turn.
#include "prefilter/remesh/simplify.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/remesh/intersections.h"
#include "prefilter/remesh/patch.h"
#include "prefilter/spatial/morton.h"

namespace prefilter {
namespace {

constexpr std::size_t kPatchTriangles = 1U << 14;
constexpr std::size_t kMeasuredEdges = 1U << 12;
constexpr int kMostPasses = 16;
// Of the tolerance, for the points that are measured; the rest is for what lies between them.
constexpr double kMeasuredShare = 0.78;
// A pass that removes less than this share of the triangles is the last one.
constexpr double kLeastRemoved = 0.002;
// Then patches that still meet others go back to what they were.
constexpr int kMostRepairs = 4;
constexpr double kCreaseCosine = 0.9659258262890683;  // 15 degrees
constexpr std::int32_t kUnowned = -1;
constexpr std::int32_t kSharedOwner = -2;

using Triangle = std::array<std::int32_t, 3>;

// Triangles with what Patch knows of them; what is empty is 0 everywhere.
struct Facets {
  std::vector<Triangle> triangles;
  std::vector<std::int32_t> labels;
  std::vector<std::uint8_t> creases;
  std::vector<float> errors;
  std::vector<float> deviations;
  std::vector<std::array<float, 3>> crease_errors;
  std::vector<std::uint32_t> point_ends;  // of each triangle's points
  std::vector<Vector3> points;
};

// What becomes of a patch.
struct Part {
  Facets facets;
  std::vector<std::uint8_t> is_new;  // of triangles
};

class Simplifier {
 public:
  Simplifier(FacetedMesh* mesh, double tolerance, int threads)
      : positions_(mesh->positions),
        kinds_(mesh->kinds),
        tolerance_(kMeasuredShare * tolerance),
        threads_(threads),
        has_labels_(!mesh->labels.empty()) {
    facets_.triangles = std::move(mesh->triangles);
    facets_.labels = std::move(mesh->labels);
    is_waiting_.assign(positions_.size(), 1);
    is_frozen_.assign(positions_.size(), 0);
    places_.assign(positions_.size(), 0);
    targets_.assign(positions_.size(), -1);
    const std::size_t step = facets_.triangles.size() / kMeasuredEdges + 1;
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t t = 0; t < facets_.triangles.size(); t += step) {
      const Triangle& triangle = facets_.triangles[t];
      sum += length(positions_[index(triangle[1])] - positions_[index(triangle[0])]) / tolerance_;
      ++count;
    }
    spacing_ = sum / static_cast<double>(count);
  }

  // Returns whether another pass is worth while.
  bool pass(int number, const Progress& progress) {
    const std::size_t count = facets_.triangles.size();
    patch_count_ = (count + kPatchTriangles - 1) / kPatchTriangles;
    divide(number, progress.part(0.0, 0.1));
    std::vector<Part> parts(patch_count_);
    const auto run = [&](std::int64_t i) {
      simplify_patch(static_cast<std::size_t>(i), &parts[static_cast<std::size_t>(i)]);
    };
    parallel_for(static_cast<std::int64_t>(patch_count_), threads_, progress.part(0.1, 0.8), run);
    repair(&parts, progress.part(0.8, 1.0));
    join(&parts);
    const std::size_t removed = count - facets_.triangles.size();
    return patch_count_ > 1 && (number == 0 || static_cast<double>(removed) >=
                                                   kLeastRemoved * static_cast<double>(count));
  }

  // The mesh, without the vertices that no triangle has.
  void finish(FacetedMesh* mesh) {
    std::vector<std::int32_t> places(positions_.size(), -1);
    for (const Triangle& triangle : facets_.triangles) {
      for (const std::int32_t vertex : triangle) places[static_cast<std::size_t>(vertex)] = 0;
    }
    std::int32_t next = 0;
    for (std::size_t v = 0; v < places.size(); ++v) {
      if (places[v] < 0) continue;
      places[v] = next;
      positions_[static_cast<std::size_t>(next)] = positions_[v];
      if (!kinds_.empty()) kinds_[static_cast<std::size_t>(next)] = kinds_[v];
      ++next;
    }
    positions_.resize(static_cast<std::size_t>(next));
    if (!kinds_.empty()) kinds_.resize(static_cast<std::size_t>(next));
    for (Triangle& triangle : facets_.triangles) {
      for (std::int32_t& vertex : triangle) vertex = places[static_cast<std::size_t>(vertex)];
    }
    mesh->triangles = std::move(facets_.triangles);
    mesh->labels = std::move(facets_.labels);
  }

 private:
  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

  std::span<const std::uint32_t> patch_triangles(std::size_t patch) const {
    const std::size_t begin = patch * kPatchTriangles;
    return std::span(order_).subspan(begin, std::min(kPatchTriangles, order_.size() - begin));
  }

  // Orders the triangles along the Morton curve through cells that lie elsewhere in each pass, and
  // finds which vertices belong to one patch only.
  void divide(int number, const Progress& progress) {
    const std::size_t count = facets_.triangles.size();
    order_.resize(count);
    owners_.assign(positions_.size(), kUnowned);
    if (patch_count_ <= 1) {
      for (std::size_t t = 0; t < count; ++t) order_[t] = static_cast<std::uint32_t>(t);
    } else {
      sort_triangles(number, progress.part(0.0, 0.7));
    }
    const auto own = [&](std::int64_t patch) {
      const auto owner = static_cast<std::int32_t>(patch);
      for (const std::uint32_t t : patch_triangles(static_cast<std::size_t>(patch))) {
        for (const std::int32_t v : facets_.triangles[t]) {
          const std::atomic_ref<std::int32_t> found(owners_[index(v)]);
          std::int32_t before = found.load(std::memory_order_relaxed);
          if (before == owner || before == kSharedOwner) continue;
          if (before == kUnowned &&
              found.compare_exchange_strong(before, owner, std::memory_order_relaxed)) {
            continue;
          }
          found.store(kSharedOwner, std::memory_order_relaxed);
        }
      }
    };
    parallel_for(static_cast<std::int64_t>(patch_count_), threads_, progress.part(0.7, 1.0), own);
  }

  void sort_triangles(int number, const Progress& progress) {
    Box box = kEmptyBox;
    for (const Vector3& p : positions_) box.include(p);
    const double size = std::max({box.size(0), box.size(1), box.size(2)});
    const std::size_t count = facets_.triangles.size();
    const int bits = std::clamp(static_cast<int>(std::bit_width(count / 32)) / 2 + 1, 1, 7);
    const double whole = std::ldexp(1.0, bits);
    const double shift = number * 0.381966 - std::floor(number * 0.381966);
    std::vector<std::uint32_t> keys(count);
    constexpr std::int64_t kGrain = 1 << 15;
    const auto set_keys = [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t t = begin; t < end; ++t) {
        const Vector3& p = positions_[index(facets_.triangles[static_cast<std::size_t>(t)][0])];
        std::array<int, 3> cell;
        for (int a = 0; a < 3; ++a) {
          const double along = ((p[a] - box.low[a]) / size + shift) / 2.0;
          cell[a] = std::clamp(static_cast<int>(along * whole), 0, (1 << bits) - 1);
        }
        keys[static_cast<std::size_t>(t)] = static_cast<std::uint32_t>(morton_index(cell));
      }
    };
    parallel_ranges(static_cast<std::int64_t>(count), kGrain, threads_, progress, set_keys);
    std::vector<std::uint32_t> begins((std::size_t{1} << (3 * bits)) + 1, 0);
    for (const std::uint32_t key : keys) ++begins[key + 1];
    for (std::size_t i = 1; i < begins.size(); ++i) begins[i] += begins[i - 1];
    for (std::size_t t = 0; t < count; ++t) {
      order_[begins[keys[t]]++] = static_cast<std::uint32_t>(t);
    }
  }

  // Numbers the vertices of a patch, and returns the ones that it shares, in order.
  std::vector<std::int32_t> number_vertices(std::size_t patch,
                                            std::vector<std::int32_t>* vertices) {
    std::vector<std::int32_t> shared;
    const auto owner = static_cast<std::int32_t>(patch);
    for (const std::uint32_t t : patch_triangles(patch)) {
      for (const std::int32_t v : facets_.triangles[t]) {
        if (owners_[index(v)] == kSharedOwner) shared.push_back(v);
      }
    }
    std::sort(shared.begin(), shared.end());
    shared.erase(std::unique(shared.begin(), shared.end()), shared.end());
    *vertices = shared;
    for (const std::uint32_t t : patch_triangles(patch)) {
      for (const std::int32_t v : facets_.triangles[t]) {
        if (owners_[index(v)] != owner) continue;
        const auto place = index(places_[index(v)]);
        if (place < vertices->size() && place >= shared.size() && (*vertices)[place] == v) continue;
        places_[index(v)] = static_cast<std::int32_t>(vertices->size());
        vertices->push_back(v);
      }
    }
    return shared;
  }

  void simplify_patch(std::size_t number, Part* part) {
    std::vector<std::int32_t> vertices;
    const std::vector<std::int32_t> shared = number_vertices(number, &vertices);
    Patch patch;
    patch.spacing = spacing_;
    const Vector3 origin = positions_[index(vertices.front())];
    const auto local = [&](const Vector3& p) {
      const Vector3 d = p - origin;
      return Vector3{d[0] / tolerance_, d[1] / tolerance_, d[2] / tolerance_};
    };
    bool is_any_waiting = false;
    patch.positions.reserve(vertices.size());
    patch.flags.reserve(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const std::size_t v = index(vertices[i]);
      patch.positions.push_back(local(positions_[v]));
      unsigned flags = i < shared.size() ? unsigned{Patch::kShared} : 0U;
      if (is_frozen_[v] != 0) flags |= Patch::kKept;
      if (is_waiting_[v] != 0) {
        flags |= Patch::kWaiting;
        is_any_waiting = is_any_waiting || flags == Patch::kWaiting;
      }
      patch.flags.push_back(static_cast<std::uint8_t>(flags));
    }
    const std::span<const std::uint32_t> chosen = patch_triangles(number);
    patch.triangles.resize(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const std::uint32_t t = chosen[i];
      PatchTriangle& made = patch.triangles[i];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t v = facets_.triangles[t][k];
        if (owners_[index(v)] == kSharedOwner) {
          const auto found = std::lower_bound(shared.begin(), shared.end(), v);
          made.corners[k] = static_cast<std::int32_t>(found - shared.begin());
        } else {
          made.corners[k] = places_[index(v)];
        }
      }
      if (has_labels_) made.label = facets_.labels[t];
      if (!facets_.creases.empty()) made.creases = facets_.creases[t];
      if (!facets_.errors.empty()) made.error = facets_.errors[t];
      if (!facets_.deviations.empty()) made.deviation = facets_.deviations[t];
      if (!facets_.crease_errors.empty()) made.crease_errors = facets_.crease_errors[t];
      if (facets_.point_ends.empty()) continue;
      for (std::uint32_t p = t == 0 ? 0 : facets_.point_ends[t - 1]; p < facets_.point_ends[t];
           ++p) {
        patch.points.push_back({local(facets_.points[p]), made.first_point});
        made.first_point = static_cast<std::int32_t>(patch.points.size()) - 1;
      }
    }
    if (is_any_waiting) {
      if (has_labels_ || !kinds_.empty()) find_creases(&patch, vertices);
      prefilter::simplify_patch(&patch);
    }
    for (std::size_t i = shared.size(); i < vertices.size(); ++i) {
      targets_[index(vertices[i])] = -1;
      if (!is_any_waiting) continue;
      const std::int32_t target = patch.targets[i];
      if (target >= 0) targets_[index(vertices[i])] = vertices[index(target)];
    }
    const auto global = [&](const Vector3& p) {
      return origin + Vector3{p[0] * tolerance_, p[1] * tolerance_, p[2] * tolerance_};
    };
    Facets& made = part->facets;
    made = {};
    part->is_new.clear();
    for (const PatchTriangle& t : patch.triangles) {
      if (t.corners[0] == t.corners[1]) continue;
      made.triangles.push_back({vertices[index(t.corners[0])], vertices[index(t.corners[1])],
                                vertices[index(t.corners[2])]});
      if (has_labels_) made.labels.push_back(t.label);
      if (has_labels_ || !kinds_.empty()) {
        made.creases.push_back(t.creases);
        made.crease_errors.push_back(t.crease_errors);
      }
      made.errors.push_back(t.error);
      made.deviations.push_back(t.deviation);
      for (std::int32_t p = t.first_point; p >= 0; p = patch.points[index(p)].next) {
        made.points.push_back(global(patch.points[index(p)].position));
      }
      made.point_ends.push_back(static_cast<std::uint32_t>(made.points.size()));
      part->is_new.push_back(t.is_new ? 1 : 0);
    }
  }

  bool is_surface(std::int32_t v) const {
    return !kinds_.empty() && kinds_[index(v)] == VertexKind::kSurface;
  }

  // Sets the creases of sides whose other triangle is in the patch, and keeps the corners where not
  // just two creases meet.
  void find_creases(Patch* patch, const std::vector<std::int32_t>& vertices) const {
    struct Side {
      std::int32_t low;
      std::int32_t high;
      std::uint32_t side;
      bool operator<(const Side& other) const {
        if (low != other.low) return low < other.low;
        return high != other.high ? high < other.high : side < other.side;
      }
    };
    std::vector<Side> sides;
    for (std::size_t t = 0; t < patch->triangles.size(); ++t) {
      const auto& corners = patch->triangles[t].corners;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto [low, high] = std::minmax(corners[i], corners[(i + 1) % 3]);
        if (is_surface(vertices[index(low)]) || is_surface(vertices[index(high)])) continue;
        sides.push_back({low, high, static_cast<std::uint32_t>(3 * t + i)});
      }
    }
    std::sort(sides.begin(), sides.end());
    const auto unit_normal = [&](const PatchTriangle& t) {
      const Vector3& a = patch->positions[index(t.corners[0])];
      const Vector3 n = cross(patch->positions[index(t.corners[1])] - a,
                              patch->positions[index(t.corners[2])] - a);
      const double size = length(n);
      return Vector3{n[0] / size, n[1] / size, n[2] / size};
    };
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
      if (sides[i].low != sides[i + 1].low || sides[i].high != sides[i + 1].high) continue;
      PatchTriangle& a = patch->triangles[sides[i].side / 3];
      PatchTriangle& b = patch->triangles[sides[i + 1].side / 3];
      const bool is_border = a.label != b.label && a.label != kNoLabel && b.label != kNoLabel;
      const bool is_crease =
          is_border || (!kinds_.empty() && dot(unit_normal(a), unit_normal(b)) < kCreaseCosine);
      if (!is_crease) continue;
      a.creases = static_cast<std::uint8_t>(a.creases | (1U << (sides[i].side % 3)));
      b.creases = static_cast<std::uint8_t>(b.creases | (1U << (sides[i + 1].side % 3)));
    }
    if (kinds_.empty()) return;
    std::vector<std::uint8_t> counts(vertices.size(), 0);
    for (const PatchTriangle& t : patch->triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        std::uint8_t& count = counts[index(t.corners[i])];
        if (((t.creases >> i) & 1U) != 0 && count < 3) ++count;
      }
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      if (kinds_[index(vertices[v])] != VertexKind::kCorner || counts[v] == 2) continue;
      patch->flags[v] = static_cast<std::uint8_t>(patch->flags[v] | Patch::kKept);
    }
  }

  // Where new triangles meet others, the vertices that they come from stay.
  void repair(std::vector<Part>* parts, const Progress& progress) {
    for (int round = 0;; ++round) {
      const double begin = 1.0 - std::ldexp(1.0, -round);
      const Progress step = progress.part(begin, 1.0 - std::ldexp(1.0, -round - 1));
      std::vector<Triangle> triangles;
      std::vector<std::uint8_t> is_suspect;
      std::vector<std::uint32_t> patches;
      for (std::size_t i = 0; i < parts->size(); ++i) {
        const Part& part = (*parts)[i];
        triangles.insert(triangles.end(), part.facets.triangles.begin(),
                         part.facets.triangles.end());
        patches.resize(triangles.size(), static_cast<std::uint32_t>(i));
        is_suspect.insert(is_suspect.end(), part.is_new.begin(), part.is_new.end());
      }
      if (std::find(is_suspect.begin(), is_suspect.end(), 1) == is_suspect.end()) return;
      const MeshView<std::int32_t> view{positions_, triangles};
      const auto pairs = intersecting_triangles(view, is_suspect, step.part(0.0, 0.5), threads_);
      if (pairs.empty()) return;
      std::vector<std::uint8_t> is_bad(positions_.size(), 0);
      std::vector<std::uint8_t> is_again(parts->size(), 0);
      for (const auto& pair : pairs) {
        for (const std::uint32_t t : pair) {
          is_again[patches[t]] = 1;
          for (const std::int32_t v : triangles[t]) is_bad[index(v)] = 1;
        }
      }
      std::vector<std::int64_t> again;
      for (std::size_t i = 0; i < parts->size(); ++i) {
        if (is_again[i] != 0) again.push_back(static_cast<std::int64_t>(i));
      }
      const auto rerun = [&](std::int64_t i) {
        const auto patch = static_cast<std::size_t>(again[static_cast<std::size_t>(i)]);
        freeze(patch, is_bad, round >= kMostRepairs);
        simplify_patch(patch, &(*parts)[patch]);
      };
      parallel_for(static_cast<std::int64_t>(again.size()), threads_, step.part(0.5, 1.0), rerun);
    }
  }

  // Keeps what was collapsed onto a bad vertex, or all that is the patch's own.
  void freeze(std::size_t patch, const std::vector<std::uint8_t>& is_bad, bool all) {
    const auto owner = static_cast<std::int32_t>(patch);
    for (const std::uint32_t t : patch_triangles(patch)) {
      for (const std::int32_t v : facets_.triangles[t]) {
        if (owners_[index(v)] != owner || is_frozen_[index(v)] != 0) continue;
        std::int32_t end = v;
        while (owners_[index(end)] == owner && targets_[index(end)] >= 0) {
          end = targets_[index(end)];
        }
        if (all || is_bad[index(end)] != 0) is_frozen_[index(v)] = 1;
      }
    }
  }

  // Makes the parts the mesh.
  void join(std::vector<Part>* parts) {
    facets_ = {};
    std::size_t triangles = 0;
    std::size_t points = 0;
    for (const Part& part : *parts) {
      triangles += part.facets.triangles.size();
      points += part.facets.points.size();
    }
    facets_.triangles.reserve(triangles);
    facets_.point_ends.reserve(triangles);
    facets_.points.reserve(points);
    const auto append = [](auto* all, auto* some) {
      all->insert(all->end(), some->begin(), some->end());
    };
    for (Part& part : *parts) {
      const auto first = static_cast<std::uint32_t>(facets_.points.size());
      append(&facets_.triangles, &part.facets.triangles);
      append(&facets_.labels, &part.facets.labels);
      append(&facets_.creases, &part.facets.creases);
      append(&facets_.errors, &part.facets.errors);
      append(&facets_.deviations, &part.facets.deviations);
      append(&facets_.crease_errors, &part.facets.crease_errors);
      append(&facets_.points, &part.facets.points);
      for (const std::uint32_t end : part.facets.point_ends) {
        facets_.point_ends.push_back(first + end);
      }
      part = {};
    }
    for (std::size_t v = 0; v < owners_.size(); ++v) {
      if (owners_[v] >= 0) is_waiting_[v] = 0;
    }
  }

  std::vector<Vector3>& positions_;
  std::vector<VertexKind>& kinds_;
  double tolerance_;
  double spacing_ = 0.0;  // of vertices, in tolerances
  int threads_;
  bool has_labels_;
  Facets facets_;
  std::size_t patch_count_ = 0;
  std::vector<std::uint32_t> order_;      // of triangles: those of a patch are together
  std::vector<std::int32_t> owners_;      // of vertices: a patch, kSharedOwner or kUnowned
  std::vector<std::int32_t> places_;      // of vertices with an owner, in its patch
  std::vector<std::int32_t> targets_;     // of vertices that are gone in this pass
  std::vector<std::uint8_t> is_waiting_;  // vertices whose surroundings have changed
  std::vector<std::uint8_t> is_frozen_;   // vertices that stay, as intersections come of their end
};

}  // namespace

FacetedMesh simplify(FacetedMesh mesh, double tolerance, const Progress& progress, int threads) {
  if (!(tolerance >= 0.0 && tolerance <= kLargestCoordinate)) {
    throw_invalid("tolerance: found " + to_text(tolerance) + "; allowed are 0 and more");
  }
  if (tolerance > 0.0 && !mesh.triangles.empty()) {
    Simplifier simplifier(&mesh, tolerance, threads);
    double begin = 0.0;
    for (int i = 0; i < kMostPasses; ++i) {
      const double end = begin + 0.6 * (1.0 - begin);
      if (!simplifier.pass(i, progress.part(begin, end))) break;
      begin = end;
    }
    simplifier.finish(&mesh);
  }
  progress.report(1.0);
  return mesh;
}

}  // namespace prefilter
