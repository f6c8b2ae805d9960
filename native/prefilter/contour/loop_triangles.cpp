// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/contour/loop_triangles.h"

namespace prefilter {
namespace {

using Triangle = std::array<std::int32_t, 3>;

// Vertices on edges of the shape are corners where not just two edges of the mesh follow these.
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
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const SharpLoop& loop = loops.loops[i];
    if (is_sharp[i] == 0) {
      for (std::size_t t = loop.first; t < loop.end; ++t) {
        add(plain[t], label_of(samples, plain[t]), i, -1);
      }
      continue;
    }
    for (std::size_t k = 0; k < loops.side_count(i); ++k) {
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
