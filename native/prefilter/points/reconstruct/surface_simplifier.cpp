// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/surface_simplifier.h"

#include <algorithm>
#include <utility>

#include "prefilter/points/reconstruct/cut_builder.h"
#include "prefilter/points/trim_surface.h"
#include "prefilter/voxels/remesh/patch.h"
#include "prefilter/voxels/remesh/simplify_facets.h"

namespace prefilter {
namespace {

using Triangle = std::array<std::int32_t, 3>;

// Width, in rings of triangles, of the waiting region around an open end that later parts continue.
constexpr int kWaitingRings = 3;

bool has_any(const Triangle& triangle, const std::vector<std::uint8_t>& flags) {
  return (flags[as_index(triangle[0])] | flags[as_index(triangle[1])] |
          flags[as_index(triangle[2])]) != 0;
}

// Flags the vertices of edges that do not have exactly two triangles.
void flag_open_vertices(std::span<const Triangle> triangles, std::vector<std::uint8_t>* is_open) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& triangle : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      edges.emplace_back(std::minmax({triangle[i], triangle[(i + 1) % 3]}));
    }
  }
  std::sort(edges.begin(), edges.end());
  for (auto first = edges.begin(); first != edges.end();) {
    const auto end = std::find_if(first, edges.end(), [&](const auto& e) { return e != *first; });
    if (end - first != 2) {
      (*is_open)[as_index(first->first)] = 1;
      (*is_open)[as_index(first->second)] = 1;
    }
    first = end;
  }
}

// Adds the vertices of all triangles that touch flagged vertices.
void grow_by_ring(std::span<const Triangle> triangles, std::vector<std::uint8_t>* is_near) {
  const std::vector<std::uint8_t> before = *is_near;
  for (const Triangle& triangle : triangles) {
    if (!has_any(triangle, before)) continue;
    for (const std::int32_t v : triangle) (*is_near)[as_index(v)] = 1;
  }
}

// Appends facets that have not been simplified yet.
void append_new(std::vector<Triangle>* triangles, Facets* facets) {
  Facets chosen;
  chosen.errors.assign(triangles->size(), 0.0F);
  chosen.deviations.assign(triangles->size(), 0.0F);
  chosen.point_ends.assign(triangles->size(), 0U);
  chosen.triangles = std::exchange(*triangles, {});
  append(&chosen, facets);
}

// The facets around chosen vertices, with their simplification history.
Facets facets_around(const Facets& facets, const std::vector<std::uint8_t>& is_chosen) {
  Facets chosen;
  std::uint32_t begin = 0;
  for (std::size_t t = 0; t < facets.triangles.size(); ++t) {
    const std::uint32_t end = facets.point_ends[t];
    if (has_any(facets.triangles[t], is_chosen)) {
      chosen.triangles.push_back(facets.triangles[t]);
      chosen.errors.push_back(facets.errors[t]);
      chosen.deviations.push_back(facets.deviations[t]);
      chosen.points.insert(chosen.points.end(), facets.points.begin() + begin,
                           facets.points.begin() + end);
      chosen.point_ends.push_back(static_cast<std::uint32_t>(chosen.points.size()));
    }
    begin = end;
  }
  return chosen;
}

}  // namespace

SurfaceSimplifier::SurfaceSimplifier(SimplifierOptions options, MeshSink* sink)
    : options_(std::move(options)), sink_(sink) {}

void SurfaceSimplifier::add_vertices(std::vector<Vector3> positions,
                                     std::vector<float> attributes) {
  Pending& all = pending_;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    all.places.emplace(next_number_, static_cast<std::int32_t>(all.numbers.size()));
    all.numbers.push_back(next_number_++);
  }
  all.mesh.positions.insert(all.mesh.positions.end(), positions.begin(), positions.end());
  all.attributes.insert(all.attributes.end(), attributes.begin(), attributes.end());
  all.out_numbers.resize(all.numbers.size(), -1);
}

void SurfaceSimplifier::add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) {
  added_.reserve(added_.size() + triangles.size());
  for (const auto& [a, b, c] : triangles) {
    added_.push_back({pending_.places.at(a), pending_.places.at(b), pending_.places.at(c)});
  }
}

void SurfaceSimplifier::end_part(std::span<const std::int64_t> shared) {
  std::vector<std::uint8_t> is_waiting(pending_.numbers.size(), 0);
  for (const std::int64_t number : shared) is_waiting[as_index(pending_.places.at(number))] = 1;
  if (!added_.empty()) {
    const SimplifyScale scale = scale_of(pending_.mesh.positions, added_, options_.tolerance);
    append_new(&added_, &pending_.facets);
    FixedVertices fixed{is_waiting, far_vertices()};
    flag_open_vertices(pending_.facets.triangles, &fixed.is_open);
    simplify_facets(pending_.mesh, scale, std::move(fixed), options_.run, &pending_.facets);
  }
  for (int ring = 1; ring < kWaitingRings; ++ring)
    grow_by_ring(pending_.facets.triangles, &is_waiting);
  output_finished(is_waiting);
  retain_waiting(is_waiting, shared);
}

std::span<const float> SurfaceSimplifier::attributes_of(std::size_t vertex) const {
  return std::span(pending_.attributes).subspan(vertex * options_.width, options_.width);
}

// Flags vertices that fill holes: only there can the mesh still be cut.
std::vector<std::uint8_t> SurfaceSimplifier::far_vertices() const {
  std::vector<std::uint8_t> is_far(pending_.numbers.size(), 0);
  if (!options_.has_support) return is_far;
  const double limit = TrimOptions().distance;
  for (std::size_t v = 0; v < is_far.size(); ++v) {
    const float distance = attributes_of(v)[options_.width - kSupportAttributes];
    is_far[v] = static_cast<double>(distance) > limit ? 1 : 0;
  }
  return is_far;
}

// Outputs all triangles except those around waiting vertices.
void SurfaceSimplifier::output_finished(const std::vector<std::uint8_t>& is_waiting) {
  std::vector<Vector3> positions;
  std::vector<float> attributes;
  std::vector<std::array<std::int64_t, 3>> triangles;
  const auto number_of = [&](std::size_t v) {
    std::int64_t& number = pending_.out_numbers[v];
    if (number >= 0) return number;
    positions.push_back(pending_.mesh.positions[v]);
    const std::span<const float> chosen = attributes_of(v);
    attributes.insert(attributes.end(), chosen.begin(), chosen.end());
    return number = static_cast<std::int64_t>(counts_.vertices++);
  };
  for (const Triangle& triangle : pending_.facets.triangles) {
    if (has_any(triangle, is_waiting)) continue;
    std::array<std::int64_t, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = number_of(as_index(triangle[i]));
    triangles.push_back(corners);
  }
  counts_.triangles += triangles.size();
  if (!positions.empty()) sink_->add_vertices(std::move(positions), std::move(attributes));
  if (!triangles.empty()) sink_->add_triangles(std::move(triangles));
}

// Keeps the waiting facets, and the vertices to which later parts refer.
void SurfaceSimplifier::retain_waiting(const std::vector<std::uint8_t>& is_waiting,
                                       std::span<const std::int64_t> shared) {
  Pending waiting;
  waiting.facets = facets_around(pending_.facets, is_waiting);
  std::vector<std::uint8_t> is_kept(pending_.numbers.size(), 0);
  for (const std::int64_t number : shared) is_kept[as_index(pending_.places.at(number))] = 1;
  for (const Triangle& triangle : waiting.facets.triangles) {
    for (const std::int32_t v : triangle) is_kept[as_index(v)] = 1;
  }
  std::vector<std::int32_t> places(pending_.numbers.size(), -1);
  for (std::size_t v = 0; v < is_kept.size(); ++v) {
    if (is_kept[v] == 0) continue;
    places[v] = static_cast<std::int32_t>(waiting.numbers.size());
    waiting.places.emplace(pending_.numbers[v], places[v]);
    waiting.numbers.push_back(pending_.numbers[v]);
    waiting.out_numbers.push_back(pending_.out_numbers[v]);
    waiting.mesh.positions.push_back(pending_.mesh.positions[v]);
    const std::span<const float> chosen = attributes_of(v);
    waiting.attributes.insert(waiting.attributes.end(), chosen.begin(), chosen.end());
  }
  for (Triangle& triangle : waiting.facets.triangles) {
    for (std::int32_t& v : triangle) v = places[as_index(v)];
  }
  pending_ = std::move(waiting);
}

}  // namespace prefilter
