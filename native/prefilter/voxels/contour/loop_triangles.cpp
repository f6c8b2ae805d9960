// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/loop_triangles.h"

#include <array>
#include <cstddef>
#include <vector>

#include "prefilter/voxels/contour/marching_table.h"

namespace prefilter {
namespace {

constexpr double kLoopTrianglesLeastCosine = 0.05;  // minimum cosine of an upright triangle

using Triangle = std::array<std::int32_t, 3>;

// Vertices on edges of the shape are corners unless exactly two mesh edges follow these edges.
std::vector<std::int32_t> add_vertices(const LinkedLoops& loops, std::span<const Feature> features,
                                       std::span<const std::uint8_t> is_sharp,
                                       std::span<const std::size_t> merged, FacetedMesh* mesh) {
  const std::size_t first = mesh->positions.size();
  std::vector<std::int32_t> places(loops.size(), -1);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (is_sharp[i] == 0) continue;
    if (merged[i] != i) {
      places[i] = places[merged[i]];
      continue;
    }
    places[i] = static_cast<std::int32_t>(mesh->positions.size());
    mesh->positions.push_back(features[i].position);
    mesh->kinds.push_back(VertexKind::kEdge);
  }
  std::vector<std::uint8_t> joints(mesh->positions.size() - first, 0);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (is_sharp[i] == 0) continue;
    const auto place = static_cast<std::size_t>(places[i]);
    if (features[i].is_corner) mesh->kinds[place] = VertexKind::kCorner;
    for (const std::size_t other : loops.joined(i, is_sharp)) {
      if (merged[other] != merged[i]) ++joints[place - first];
    }
  }
  for (std::size_t v = 0; v < joints.size(); ++v) {
    if (joints[v] != 2) mesh->kinds[first + v] = VertexKind::kCorner;
  }
  return places;
}

// The part of a loop on one side of an edge: the loop's vertex, and consecutive corners from one
// joined side to the next.
class LoopPart {
 public:
  // `first` is the corner after a joined side.
  LoopPart(const LinkedLoops& loops, std::size_t loop, std::size_t first, std::int32_t place,
           std::span<const std::uint8_t> is_sharp, const VertexSamples& samples,
           const FacetedMesh& mesh)
      : sides_(loops.sides[loop]), mesh_(mesh) {
    const std::size_t count = loops.side_count(loop);
    vertices_[0] = place;
    for (std::size_t k = first;; k = (k + 1) % count) {
      corners_[size_] = k;
      vertices_[size_++] = loops.loops[loop].from(k);
      if (loops.is_joined(loop, k, is_sharp)) break;
    }
    find_normal(samples);
  }

  std::size_t count() const { return size_ - 1; }
  std::int32_t label() const { return label_; }

  // Whether the fan around the loop's vertex has a triangle that is upside down.
  bool is_folded() const {
    if (normal_ == Vector3{} || size_ > kMost) return false;
    // A single triangle has no alternative.
    for (int k = 1; size_ > 3 && k + 1 < static_cast<int>(size_); ++k) {
      if (cosine_of(0, k, k + 1) < kLoopTrianglesLeastCosine) return true;
    }
    return false;
  }

  // The best triangulation; none if it also has a triangle that is upside down, in which case the
  // fan stays and is found when mending. The fan is always among the candidates.
  std::vector<Triangle> upright_triangles() const {
    const auto is_allowed = [&](int i, int j) {
      if (i == 0 || j == 0) return true;
      const std::size_t a = corners_[static_cast<std::size_t>(i)];
      const std::size_t b = corners_[static_cast<std::size_t>(j)];
      return ((sides_[a].shared >> b) & 1U) == 0U;
    };
    const auto cost = [&](int i, int j, int k) {
      constexpr double kFolded = 100.0;
      const double cosine = cosine_of(i, j, k);
      return cosine < kLoopTrianglesLeastCosine ? kFolded - cosine : 1.0 - cosine;
    };
    std::vector<Triangle> triangles;
    bool is_upright = true;
    triangulate_loop(static_cast<int>(size_), is_allowed, cost, [&](int i, int j, int k) {
      is_upright = is_upright && cosine_of(i, j, k) >= kLoopTrianglesLeastCosine;
      triangles.push_back({vertex(i), vertex(j), vertex(k)});
    });
    if (!is_upright) triangles.clear();
    return triangles;
  }

 private:
  static constexpr std::size_t kMost = 12;  // maximum number of vertices to triangulate

  std::int32_t vertex(int i) const { return vertices_[static_cast<std::size_t>(i)]; }

  // Normal of the region to which all vertices belong; none if there are several.
  void find_normal(const VertexSamples& samples) {
    Vector3 sum{};
    float facing = 0.0F;
    const SourcePoint* first = samples.of(vertices_[1]);
    if (first == nullptr) return;
    for (std::size_t i = 1; i < size_; ++i) {
      const SourcePoint* sample = samples.of(vertices_[i]);
      if (sample == nullptr || sample->label != first->label) return;
      sum = sum + sample->normal;
      facing += samples.facing[static_cast<std::size_t>(
          samples.index[static_cast<std::size_t>(vertices_[i])])];
    }
    const double size = length(sum);
    label_ = first->label;
    if (size > 0.0 && facing != 0.0F) normal_ = ((facing > 0.0F ? 1.0 : -1.0) / size) * sum;
  }

  double cosine_of(int i, int j, int k) const {
    const auto at = [&](int n) -> const Vector3& {
      return mesh_.positions[static_cast<std::size_t>(vertex(n))];
    };
    const Vector3 normal = cross(at(j) - at(i), at(k) - at(i));
    const double size = length(normal);
    return size > 0.0 ? dot(normal, normal_) / size : 0.0;
  }

  const std::array<LoopSide, 12>& sides_;
  const FacetedMesh& mesh_;
  std::array<std::size_t, kMost + 1> corners_{};
  std::array<std::int32_t, kMost + 1> vertices_{};
  std::size_t size_ = 1;
  Vector3 normal_{};
  std::int32_t label_ = -1;
};

std::int32_t label_of(const VertexSamples& samples, std::int32_t vertex) {
  const SourcePoint* sample = samples.of(vertex);
  return sample != nullptr ? sample->label : -1;
}
}  // namespace

std::int32_t label_of(const VertexSamples& samples, const Triangle& triangle) {
  for (const std::int32_t corner : triangle) {
    if (static_cast<std::size_t>(corner) >= samples.index.size()) continue;
    const std::int32_t label = label_of(samples, corner);
    if (label >= 0) return label;
  }
  return -1;
}

LoopTriangles add_loops(const LinkedLoops& loops, std::span<const Triangle> plain,
                        std::span<const Feature> features, std::span<const std::uint8_t> is_sharp,
                        std::span<const std::size_t> merged, const VertexSamples& samples,
                        FacetedMesh* mesh) {
  LoopTriangles made;
  made.places = add_vertices(loops, features, is_sharp, merged, mesh);
  const auto add = [&](const Triangle& triangle, std::int32_t label, std::size_t i,
                       std::int32_t other) {
    mesh->triangles.push_back(triangle);
    mesh->labels.push_back(label);
    made.owners.push_back({static_cast<std::int32_t>(i), other});
  };
  // Adds the parts whose fans fold; returns flags of their sides.
  const auto add_folded_parts = [&](std::size_t i) {
    const std::size_t count = loops.side_count(i);
    std::array<std::uint8_t, 12> is_made{};
    for (std::size_t k = 0; k < count; ++k) {
      if (!loops.is_joined(i, k, is_sharp)) continue;
      const LoopPart part(loops, i, (k + 1) % count, made.places[i], is_sharp, samples, *mesh);
      if (!part.is_folded()) continue;
      const std::vector<Triangle> triangles = part.upright_triangles();
      for (const Triangle& triangle : triangles) add(triangle, part.label(), i, -1);
      if (triangles.empty()) continue;
      for (std::size_t n = 1; n < part.count(); ++n) is_made[(k + n) % count] = 1;
    }
    return is_made;
  };
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const SharpLoop& loop = loops.loops[i];
    if (is_sharp[i] == 0) {
      for (std::size_t t = loop.first; t < loop.end; ++t) {
        add(plain[t], label_of(samples, plain[t]), i, -1);
      }
      continue;
    }
    const std::array<std::uint8_t, 12> is_made = add_folded_parts(i);
    for (std::size_t k = 0; k < loops.side_count(i); ++k) {
      if (is_made[k] != 0) continue;
      if (loops.is_joined(i, k, is_sharp)) {
        const std::int32_t other = loops.sides[i][k].other;
        const std::int32_t place = made.places[static_cast<std::size_t>(other)];
        if (place == made.places[i]) continue;
        add({made.places[i], loop.from(k), place}, label_of(samples, loop.from(k)), i, other);
      } else {
        const Triangle triangle = {made.places[i], loop.from(k), loop.to(k)};
        add(triangle, label_of(samples, triangle), i, -1);
      }
    }
  }
  return made;
}

}  // namespace prefilter
