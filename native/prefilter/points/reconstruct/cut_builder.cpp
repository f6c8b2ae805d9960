// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/cut_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "prefilter/base/disjoint_sets.h"

namespace prefilter {

void CutBuilder::add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) {
  if (part_.positions.empty()) {
    part_.positions = std::move(positions);
    part_.attributes = std::move(attributes);
  } else {
    part_.positions.insert(part_.positions.end(), positions.begin(), positions.end());
    part_.attributes.insert(part_.attributes.end(), attributes.begin(), attributes.end());
  }
}

void CutBuilder::add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) {
  if (triangles_.empty()) {
    triangles_ = std::move(triangles);
  } else {
    triangles_.insert(triangles_.end(), triangles.begin(), triangles.end());
  }
}

void CutBuilder::add_far_midpoints(const std::vector<FarMidpoint<std::int64_t>>& places) {
  for (const FarMidpoint<std::int64_t>& place : places) {
    if (place.b < 0) {
      far_triangles_.emplace(place.a, place);
    } else {
      far_edges_.emplace(std::minmax(place.a, place.b), place);
    }
  }
}

double CutBuilder::distance(std::uint32_t local) const {
  const std::size_t at = (local + std::size_t{1}) * measure_.width - kSupportAttributes;
  return static_cast<double>(part_.attributes[at]);
}

bool CutBuilder::is_lasting(std::int64_t number) const {
  return number < first_number_ || shared_.contains(number);
}

std::uint32_t CutBuilder::add_known(const Known& known) {
  const auto local = static_cast<std::uint32_t>(part_.size());
  part_.positions.push_back(known.position);
  part_.attributes.insert(part_.attributes.end(), known.attributes.begin(), known.attributes.end());
  part_.ids.push_back(known.id);
  part_.components.push_back(known.component);
  return local;
}

std::uint32_t CutBuilder::local_of(std::int64_t number) {
  if (number >= first_number_) return static_cast<std::uint32_t>(number - first_number_);
  const auto [it, is_new] = olds_.try_emplace(number, kNone);
  if (is_new) it->second = add_known(known_.at(number));
  return it->second;
}

std::uint32_t CutBuilder::add_middle(std::span<const std::uint32_t> corners,
                                     const FarMidpoint<std::int64_t>& place) {
  const double share = 1.0 / static_cast<double>(corners.size());
  Vector3 sum{};
  for (const std::uint32_t v : corners) sum = sum + part_.positions[v];
  const auto local = static_cast<std::uint32_t>(part_.size());
  part_.positions.push_back(share * sum);
  for (std::size_t a = 0; a + kSupportAttributes < measure_.width; ++a) {
    double value = 0.0;
    for (const std::uint32_t v : corners) {
      value += static_cast<double>(part_.attributes[v * measure_.width + a]);
    }
    part_.attributes.push_back(static_cast<float>(share * value));
  }
  part_.attributes.push_back(place.distance);
  part_.attributes.push_back(place.density);
  part_.ids.push_back(next_id_++);
  part_.components.push_back(-1);
  return local;
}

std::uint32_t CutBuilder::far_middle(const Edge& edge) {
  const auto made = middles_.find(edge);
  if (made != middles_.end()) return made->second;
  const auto it = far_edges_.find(edge);
  if (it == far_edges_.end()) return kNone;
  const std::uint32_t ends[] = {local_of(edge.first), local_of(edge.second)};
  const std::uint32_t middle = add_middle(ends, it->second);
  middles_.emplace(edge, middle);
  return middle;
}

// Middle vertex of an edge, kNone if it has none. Both triangles of an edge must agree even if they
// belong to different parts, so the first one decides.
std::uint32_t CutBuilder::middle_of(std::int64_t a, std::int64_t b) {
  const Edge edge = std::minmax(a, b);
  if (!is_lasting(a) || !is_lasting(b)) return far_edges_.empty() ? kNone : far_middle(edge);
  const auto it = open_edges_.find(edge);
  if (it == open_edges_.end()) {
    OpenEdge open;
    open.local = far_middle(edge);
    return open_edges_.emplace(edge, std::move(open)).first->second.local;
  }
  const OpenEdge open = std::move(it->second);
  open_edges_.erase(it);
  return open.known ? add_known(*open.known) : open.local;
}

void CutBuilder::divide_triangles() {
  part_.triangles.reserve(triangles_.size());
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    std::array<std::uint32_t, 3> corners;
    std::array<std::uint32_t, 3> middles;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = local_of(triangles_[t][i]);
    for (std::size_t i = 0; i < 3; ++i) {
      middles[i] = middle_of(triangles_[t][i], triangles_[t][(i + 1) % 3]);
    }
    const auto far_center = far_triangles_.find(static_cast<std::int64_t>(t));
    const bool is_whole =
        std::all_of(middles.begin(), middles.end(), [](std::uint32_t m) { return m == kNone; });
    if (is_whole && far_center == far_triangles_.end()) {
      part_.triangles.push_back(corners);
      continue;
    }
    std::vector<std::uint32_t> around;
    FarMidpoint<std::int64_t> place{};
    for (std::size_t i = 0; i < 3; ++i) {
      around.push_back(corners[i]);
      if (middles[i] == kNone) continue;
      around.push_back(middles[i]);
      // Without a measurement at the triangle's own center, use that of its farthest edge midpoint.
      const float* const support = part_.attributes.data() +
                                   (middles[i] + std::size_t{1}) * measure_.width -
                                   kSupportAttributes;
      if (support[0] > place.distance) place = {0, 0, support[0], support[1]};
    }
    if (far_center != far_triangles_.end()) place = far_center->second;
    const std::uint32_t middle = add_middle(corners, place);
    part_.fans.push_back({static_cast<std::uint32_t>(part_.triangles.size()),
                          static_cast<std::uint32_t>(around.size()), corners});
    for (std::size_t i = 0; i < around.size(); ++i) {
      part_.triangles.push_back({around[i], around[(i + 1) % around.size()], middle});
    }
  }
}

void CutBuilder::find_components() {
  DisjointSets<std::uint32_t> sets(part_.size());
  for (const auto& triangle : part_.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangle[i];
      const std::uint32_t b = triangle[(i + 1) % 3];
      if (is_near(a) == is_near(b)) sets.join(a, b);
    }
  }
  std::vector<std::int32_t> component_of_root(part_.size(), -1);
  for (std::uint32_t v = 0; v < part_.size(); ++v) {
    const std::int32_t before = part_.components[v];
    if (before < 0) continue;
    std::int32_t& component = component_of_root[sets.root(v)];
    component = component < 0 ? before : regions_.unite(component, before);
  }
  for (std::uint32_t v = 0; v < part_.size(); ++v) {
    std::int32_t& component = component_of_root[sets.root(v)];
    if (component < 0) component = regions_.add_piece();
    part_.components[v] = component;
    if (!is_near(v)) regions_.add_distance(component, distance(v));
  }
  for (const std::int64_t number : cut_vertices_) {
    const std::uint32_t v = local_of(number);
    if (is_near(v)) continue;
    regions_.add_distance(part_.components[v], std::numeric_limits<double>::infinity());
  }
}

void CutBuilder::measure_areas() {
  std::vector<std::pair<std::int32_t, std::int32_t>> borders;
  for (const auto& triangle : part_.triangles) {
    const auto [a, b, c] = triangle;
    const Vector3& origin = part_.positions[a];
    const double area =
        0.5 * length(cross(part_.positions[b] - origin, part_.positions[c] - origin));
    double density = 0.0;
    std::size_t near_count = 0;
    std::int32_t near = -1;
    std::int32_t far = -1;
    for (const std::uint32_t v : triangle) {
      density += static_cast<double>(part_.attributes[(v + std::size_t{1}) * measure_.width - 1]);
      (is_near(v) ? near : far) = part_.components[v];
      near_count += is_near(v) ? 1 : 0;
    }
    const double least = measure_.cell * measure_.cell;
    const double patches =
        least > 0.0 ? std::min(area * density / 3.0, area / least) : area * density / 3.0;
    double share = near < 0 ? 0.0 : 1.0;
    if (near >= 0 && far >= 0) {
      // Share of the area around the corner that is alone on its side of the cut.
      const bool is_near_lone = near_count == 1;
      double corner = 1.0;
      for (std::size_t i = 0; i < 3; ++i) {
        const double own = distance(triangle[i]);
        const double next = distance(triangle[(i + 1) % 3]);
        if ((own <= measure_.distance) == (next <= measure_.distance)) continue;
        const double at = crossing(measure_.distance, std::min(own, next), std::max(own, next));
        corner *= is_near_lone ? at : 1.0 - at;
      }
      share = is_near_lone ? corner : 1.0 - corner;
      borders.emplace_back(near, far);
    }
    if (near >= 0) regions_.add_area(near, share * area, share * patches);
    if (far >= 0) regions_.add_area(far, (1.0 - share) * area, (1.0 - share) * patches);
  }
  regions_.add_borders(std::move(borders));
}

CutBuilder::Known CutBuilder::known_of(std::uint32_t local) const {
  const auto first = part_.attributes.begin() + static_cast<std::ptrdiff_t>(local * measure_.width);
  return {part_.ids[local],
          part_.components[local],
          part_.positions[local],
          {first, first + static_cast<std::ptrdiff_t>(measure_.width)}};
}

void CutBuilder::retain_shared(std::span<const std::int64_t> shared) {
  std::unordered_map<std::int64_t, Known> known;
  for (const std::int64_t number : shared) {
    const auto old = known_.find(number);
    const Known& one = known
                           .emplace(number, old != known_.end() && !olds_.contains(number)
                                                ? std::move(old->second)
                                                : known_of(local_of(number)))
                           .first->second;
    part_.shared_ids.push_back(one.id);
  }
  known_ = std::move(known);
  std::erase_if(open_edges_, [&](const auto& entry) {
    return !shared_.contains(entry.first.first) || !shared_.contains(entry.first.second);
  });
  for (auto& [edge, open] : open_edges_) {
    if (open.local != kNone) open.known = known_of(std::exchange(open.local, kNone));
    if (open.known) part_.shared_ids.push_back(open.known->id);
  }
  std::sort(part_.shared_ids.begin(), part_.shared_ids.end());
}

CutPart CutBuilder::take_part(std::span<const std::int64_t> shared) {
  shared_.insert(shared.begin(), shared.end());
  const std::size_t count = part_.positions.size();
  part_.ids.resize(count);
  std::iota(part_.ids.begin(), part_.ids.end(), next_id_);
  next_id_ += static_cast<std::int64_t>(count);
  part_.components.assign(count, -1);
  divide_triangles();
  triangles_ = {};
  find_components();
  measure_areas();
  retain_shared(shared);
  first_number_ += static_cast<std::int64_t>(count);
  far_edges_.clear();
  far_triangles_.clear();
  cut_vertices_.clear();
  shared_.clear();
  olds_.clear();
  middles_.clear();
  return std::exchange(part_, CutPart());
}

}  // namespace prefilter
