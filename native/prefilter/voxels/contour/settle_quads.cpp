// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/settle_quads.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>
#include <utility>

#include "prefilter/voxels/contour/facing.h"
#include "prefilter/voxels/remesh/folds.h"
#include "prefilter/voxels/remesh/near_intersections.h"

namespace prefilter {
namespace {

constexpr double kSettleQuadsCubeCells = 2.0;
// Number of steps by which a vertex retreats: first to the center of its loop, then to the safe
// position.
constexpr std::uint8_t kStepsToMiddle = 3;
constexpr std::uint8_t kSettleQuadsMostSteps = 6;
constexpr std::uint8_t kMostSlides = 3;
constexpr double kWithin = 0.5 + 1e-6;  // cells; from a cell's center to its sides
constexpr double kFlat = 0.5;           // minimum cosine to the mean normal
constexpr double kSettleQuadsOpposed =
    -0.17;  // maximum cosine between normals of regions: 100 degrees
constexpr double kSettleQuadsEdgeReach = 0.3;  // cells
constexpr double kSettleQuadsNarrow = 1e-6;    // relative to a triangle's longest side

using Flags = std::vector<std::uint8_t>;
using Pairs = std::vector<std::array<std::uint32_t, 2>>;

class Settling {
 public:
  Settling(const DualLoops& loops, const DualPlaces& places, const EdgeSource& edges,
           const FeaturePlaces* features, const Vector3& cell)
      : places_(places),
        samples_(edges.samples),
        surface_of_(edges.surface()),
        features_(features),
        cell_(cell),
        steps_(loops.size(), 0),
        wanted_(places.positions),
        slides_(places.edge_vertices.size(), 0) {
    surface_.positions = places.positions;
    surface_.quads = loops.quads;
    surface_.labels.assign(loops.quads.size(), -1);
    for (std::size_t q = 0; q < loops.quads.size() && !samples_.index.empty(); ++q) {
      const SourcePoint* sample = samples_.of(static_cast<std::int32_t>(q));
      if (sample != nullptr) surface_.labels[q] = sample->label;
    }
    if (!samples_.index.empty()) turned_ = turned_labels(samples_);
    for (std::size_t q = 0; q < surface_.quads.size(); ++q) surface_.turn(q);
    triangles_ = surface_.triangles();
    is_risky_ = loops.shares_cell;
    find_risky();
  }

  // Moves vertices of faulty triangles; returns whether any moved.
  bool step(Flags* is_suspect, const Run& run) {
    const Pairs pairs = faulty_pairs(*is_suspect, run);
    Flags is_moved(surface_.positions.size(), 0);
    Flags slides(surface_.positions.size(), 0);
    for (const auto& pair : pairs) {
      if (mark_slides(pair, &slides)) continue;
      const std::int32_t vertex = to_blame(pair);
      if (vertex >= 0) is_moved[static_cast<std::size_t>(vertex)] = 1;
    }
    bool has_moved = false;
    const std::vector<std::pair<std::size_t, Vector3>> slid = slide(slides);
    for (std::size_t v = 0; v < is_moved.size(); ++v) {
      if (is_moved[v] == 0 || slides[v] != 0) continue;
      draw_back(v);
      has_moved = true;
    }
    for (const auto& [v, position] : slid) {
      surface_.positions[v] = wanted_[v] = position;
      is_moved[v] = 1;
      has_moved = true;
    }
    mark_around(is_moved, is_suspect);
    return has_moved;
  }

  QuadSurface take() { return std::move(surface_); }

 private:
  // Flat triangles whose vertices are alone in their dual cells intersect no others except at their
  // sides, because the cells of two adjacent vertices form a box.
  void find_risky() {
    std::vector<Vector3> normals(surface_.positions.size());
    const auto unit_normal = [&](const std::array<std::int32_t, 3>& triangle) -> Vector3 {
      const auto at = [&](std::size_t k) -> const Vector3& {
        return surface_.positions[static_cast<std::size_t>(triangle[k])];
      };
      const Vector3 normal = cross(at(1) - at(0), at(2) - at(0));
      const double size = std::sqrt(dot(normal, normal));
      return size > 0.0 ? (1.0 / size) * normal : Vector3{};
    };
    for (const auto& triangle : triangles_) {
      const Vector3 normal = unit_normal(triangle);
      for (const std::int32_t v : triangle) {
        normals[static_cast<std::size_t>(v)] = normals[static_cast<std::size_t>(v)] + normal;
      }
    }
    for (const auto& triangle : triangles_) {
      const Vector3 normal = unit_normal(triangle);
      for (const std::int32_t corner : triangle) {
        const auto v = static_cast<std::size_t>(corner);
        const double size = std::sqrt(dot(normals[v], normals[v]));
        if (!(dot(normal, normals[v]) > kFlat * size)) is_risky_[v] = 1;
      }
    }
    for (std::size_t v = 0; v < is_risky_.size(); ++v) {
      for (std::size_t a = 0; a < 3; ++a) {
        const double off = std::abs(surface_.positions[v][a] - places_.cells[v][a]);
        if (off > kWithin * cell_[a]) is_risky_[v] = 1;
      }
    }
  }

  Pairs faulty_pairs(const Flags& is_suspect, const Run& run) const {
    const MeshView<std::int32_t> view{surface_.positions, triangles_};
    Flags may_intersect = is_suspect;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const auto& corners = triangles_[t];
      const bool is_any = std::any_of(corners.begin(), corners.end(), [&](std::int32_t v) {
        return is_risky_[static_cast<std::size_t>(v)] != 0;
      });
      if (!is_any) may_intersect[t] = 0;
    }
    const double side = kSettleQuadsCubeCells * std::max({cell_[0], cell_[1], cell_[2]});
    Pairs pairs = near_intersections(view, 0, may_intersect, side, run);
    for (const auto& fold : folded_pairs(view, 0, is_suspect, run)) {
      if (!is_at_wedge(fold)) pairs.push_back(fold);
    }
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (is_suspect[t] != 0 && faces_away(t, view)) pairs.push_back({t, t});
    }
    return pairs;
  }

  // Whether two triangles lie along two regions that meet at less than 80 degrees, close to both.
  bool is_at_wedge(const std::array<std::uint32_t, 2>& fold) const {
    if (samples_.index.empty()) return false;
    Vector3 middle{};
    const auto& other = triangles_[fold[1]];
    for (const std::int32_t v : triangles_[fold[0]]) {
      if (std::find(other.begin(), other.end(), v) == other.end()) continue;
      middle = middle + 0.5 * surface_.positions[static_cast<std::size_t>(v)];
    }
    std::array<Vector3, 2> normals;
    for (std::size_t i = 0; i < 2; ++i) {
      const SourcePoint* sample = samples_.of(static_cast<std::int32_t>(fold[i] / 2));
      if (sample == nullptr) return false;
      if (!surface_of_->nearest(middle, kSettleQuadsEdgeReach * surface_of_->cell(),
                                sample->label)) {
        return false;
      }
      normals[i] = turned_.contains(sample->label) ? -1.0 * sample->normal : sample->normal;
    }
    return dot(normals[0], normals[1]) < kSettleQuadsOpposed;
  }

  // Whether a triangle faces away from the surface that its quad was sampled from, or is
  // degenerate.
  bool faces_away(std::uint32_t t, const MeshView<std::int32_t>& view) const {
    const auto [a, b, c] = view.corners(t);
    const Vector3 normal = cross(b - a, c - a);
    const double longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
    if (dot(normal, normal) <= kSettleQuadsNarrow * kSettleQuadsNarrow * longest * longest)
      return true;
    if (samples_.index.empty()) return false;
    const SourcePoint* sample = samples_.of(static_cast<std::int32_t>(t / 2));
    if (sample == nullptr) return false;
    const double up = dot(normal, sample->normal);
    return (turned_.contains(sample->label) ? -up : up) < 0.0;
  }

  // Flags the vertices of two triangles that may still slide; returns whether there are any.
  bool mark_slides(const std::array<std::uint32_t, 2>& pair, Flags* slides) const {
    bool is_any = false;
    for (const std::uint32_t t : pair) {
      for (const std::int32_t vertex : triangles_[t]) {
        const auto v = static_cast<std::size_t>(vertex);
        const std::int32_t edge = places_.on_edge[v];
        if (edge < 0 || steps_[v] > 0) continue;
        if (slides_[static_cast<std::size_t>(edge)] >= kMostSlides) continue;
        (*slides)[v] = 1;
        is_any = true;
      }
    }
    return is_any;
  }

  // New positions of vertices that slide to between their neighbors.
  std::vector<std::pair<std::size_t, Vector3>> slide(const Flags& slides) {
    std::vector<std::pair<std::size_t, Vector3>> slid;
    for (std::size_t v = 0; v < slides.size(); ++v) {
      if (slides[v] == 0) continue;
      const auto edge = static_cast<std::size_t>(places_.on_edge[v]);
      ++slides_[edge];
      const EdgeVertex& on = places_.edge_vertices[edge];
      const auto [a, b] = on.beside;
      const Vector3 between = 0.5 * (surface_.positions[static_cast<std::size_t>(a)] +
                                     surface_.positions[static_cast<std::size_t>(b)]);
      slid.emplace_back(v, features_->place(between, on.labels).value_or(surface_.positions[v]));
    }
    return slid;
  }

  // The vertex of two triangles that is farthest from its fallback position; corners of the shape
  // are chosen last.
  std::int32_t to_blame(const std::array<std::uint32_t, 2>& pair) const {
    std::int32_t found = -1;
    int least = std::numeric_limits<int>::max();
    double farthest = 0.0;
    for (const std::uint32_t t : pair) {
      for (const std::int32_t vertex : triangles_[t]) {
        const auto v = static_cast<std::size_t>(vertex);
        const int step = steps_[v] < kStepsToMiddle ? 0 : steps_[v];
        const int stage = places_.is_corner[v] != 0 ? kSettleQuadsMostSteps + step : step;
        if (steps_[v] >= kSettleQuadsMostSteps || stage > least) continue;
        const Vector3& target = step == 0 ? places_.middles[v] : places_.safe[v];
        const double distance = length(surface_.positions[v] - target);
        if (stage == least && found >= 0 &&
            (distance < farthest || (distance == farthest && vertex >= found))) {
          continue;
        }
        found = vertex;
        least = stage;
        farthest = distance;
      }
    }
    return found;
  }

  void draw_back(std::size_t v) {
    ++steps_[v];
    const auto toward = [](const Vector3& from, const Vector3& to, double share) {
      return (1.0 - share) * from + share * to;
    };
    if (steps_[v] <= kStepsToMiddle) {
      surface_.positions[v] =
          toward(wanted_[v], places_.middles[v], static_cast<double>(steps_[v]) / kStepsToMiddle);
    } else {
      surface_.positions[v] = toward(places_.middles[v], places_.safe[v],
                                     static_cast<double>(steps_[v] - kStepsToMiddle) /
                                         (kSettleQuadsMostSteps - kStepsToMiddle));
    }
  }

  void mark_around(const Flags& is_moved, Flags* is_suspect) {
    for (std::size_t q = 0; q < surface_.quads.size(); ++q) {
      const Quad& quad = surface_.quads[q];
      const bool is_near = std::any_of(quad.begin(), quad.end(), [&](std::int32_t v) {
        return is_moved[static_cast<std::size_t>(v)] != 0;
      });
      (*is_suspect)[2 * q] = (*is_suspect)[2 * q + 1] = is_near ? 1 : 0;
      if (!is_near) continue;
      surface_.turn(q);
      const auto& [a, b, c, d] = surface_.quads[q];
      triangles_[2 * q] = {a, b, c};
      triangles_[2 * q + 1] = {a, c, d};
    }
    for (std::size_t v = 0; v < is_moved.size(); ++v) is_risky_[v] |= is_moved[v];
  }

  const DualPlaces& places_;
  const VertexSamples& samples_;
  const FeatureSurface* surface_of_;
  const FeaturePlaces* features_;
  Vector3 cell_;
  std::unordered_set<std::int32_t> turned_;
  std::vector<std::uint8_t> steps_;
  std::vector<Vector3> wanted_;  // targets before the first step
  std::vector<std::uint8_t> slides_;
  QuadSurface surface_;
  std::vector<std::array<std::int32_t, 3>> triangles_;  // of the quads
  Flags is_risky_;                                      // per vertex
};
}  // namespace

QuadSurface settled_quads(const DualLoops& loops, const DualPlaces& places, const EdgeSource& edges,
                          const FeaturePlaces* features, const Vector3& cell, const Run& run) {
  Settling settling(loops, places, edges, features, cell);
  Flags is_suspect(2 * loops.quads.size(), 1);
  while (settling.step(&is_suspect, run)) {
  }
  return settling.take();
}

}  // namespace prefilter
