// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/mesh_joiner.h"

#include <algorithm>
#include <array>
#include <utility>

namespace prefilter {
namespace {

std::uint64_t packed(const VertexPlace& place) {
  std::uint64_t code = 0;
  for (const std::int32_t x : place.leaf) code = code << 12U | static_cast<std::uint64_t>(x);
  return (code << 4U | static_cast<std::uint64_t>(place.depth)) << 3U |
         static_cast<std::uint64_t>(place.face);
}

}  // namespace

void MeshJoiner::add(const SlabMesh& slab, int top) {
  const TriangleMesh& mesh = slab.contour.mesh;
  std::vector<std::int64_t> numbers(mesh.positions.size(), -1);
  std::vector<Vector3> positions;
  std::vector<float> attributes;
  std::vector<std::array<std::int64_t, 3>> triangles;
  positions.reserve(mesh.positions.size());
  attributes.reserve(mesh.positions.size() * attribute_count_);
  triangles.reserve(mesh.triangles.size());
  const auto number_of = [&](std::size_t v) {
    if (numbers[v] >= 0) return numbers[v];
    const VertexPlace* place = v < slab.contour.places.size() ? &slab.contour.places[v] : nullptr;
    const bool is_shared = place != nullptr && place->high(grid_.depth) >= top;
    if (place != nullptr) {
      const auto it = known_.find(packed(*place));
      if (it != known_.end()) return numbers[v] = it->second.number;
    }
    numbers[v] = static_cast<std::int64_t>(vertices_++);
    positions.push_back(grid_.from_cells(mesh.positions[v]));
    const auto first = slab.attributes.begin() + static_cast<std::ptrdiff_t>(v * attribute_count_);
    attributes.insert(attributes.end(), first,
                      first + static_cast<std::ptrdiff_t>(attribute_count_));
    if (is_shared) known_.emplace(packed(*place), Known{numbers[v], place->high(grid_.depth)});
    return numbers[v];
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array<std::size_t, 3> corners = {
        static_cast<std::size_t>(a), static_cast<std::size_t>(b), static_cast<std::size_t>(c)};
    bool is_trimmed = false;
    if (!slab.is_trimmed.empty()) {
      for (const std::size_t v : corners) is_trimmed = is_trimmed || slab.is_trimmed[v] != 0;
    }
    if (is_trimmed) continue;
    triangles.push_back({number_of(corners[0]), number_of(corners[1]), number_of(corners[2])});
  }
  triangles_ += triangles.size();
  if (!positions.empty()) sink_->add_vertices(std::move(positions), std::move(attributes));
  if (!triangles.empty()) sink_->add_triangles(std::move(triangles));
  std::erase_if(known_, [&](const auto& entry) { return entry.second.high < top; });
  far_midpoints_.clear();
  for (const auto& [a, b, distance, density] : slab.far_midpoints) {
    const bool is_edge = b >= 0;
    far_midpoints_.push_back({is_edge ? numbers[static_cast<std::size_t>(a)] : a,
                              is_edge ? numbers[static_cast<std::size_t>(b)] : -1, distance,
                              density});
  }
}

std::vector<std::int64_t> MeshJoiner::shared() const {
  std::vector<std::int64_t> numbers;
  for (const auto& [place, known] : known_) numbers.push_back(known.number);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

}  // namespace prefilter
