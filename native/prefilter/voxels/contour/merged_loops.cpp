// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/merged_loops.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "prefilter/base/disjoint_sets.h"

namespace prefilter {
namespace {

constexpr double kTooClose = 0.05;  // cells

using Triangle = std::array<std::int32_t, 3>;
using Flags = std::vector<std::uint8_t>;

bool is_in(std::int32_t vertex, const Flags& is_flagged) {
  const auto v = static_cast<std::size_t>(vertex);
  return v < is_flagged.size() && is_flagged[v] != 0;
}

// Flags the vertices shared by several loops.
Flags shared_vertices(std::span<const std::int32_t> places, std::span<const std::size_t> merged) {
  Flags is_shared;
  for (std::size_t i = 0; i < merged.size(); ++i) {
    if (merged[i] == i || places[i] < 0) continue;
    const auto place = static_cast<std::size_t>(places[i]);
    if (place >= is_shared.size()) is_shared.resize(place + 1, 0);
    is_shared[place] = 1;
  }
  return is_shared;
}

// Whether the edges opposite to a vertex form one cycle.
bool is_circle(const std::vector<std::array<std::int32_t, 2>>& link) {
  std::int32_t at = link[0][1];
  std::size_t steps = 1;
  while (at != link[0][0] && steps <= link.size()) {
    const auto next =
        std::find_if(link.begin(), link.end(), [&](const auto& side) { return side[0] == at; });
    if (next == link.end()) return false;
    at = (*next)[1];
    ++steps;
  }
  return at == link[0][0] && steps == link.size();
}
}  // namespace

std::vector<std::size_t> merged_loops(const LinkedLoops& loops, std::span<const Feature> features,
                                      std::span<const std::uint8_t> is_sharp,
                                      std::span<const std::uint8_t> is_single, double cell) {
  DisjointSets<std::size_t> merged(loops.size());
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (is_sharp[i] == 0 || is_single[i] != 0) continue;
    for (const std::size_t other : loops.joined(i, is_sharp)) {
      if (other < i || is_single[other] != 0) continue;
      if (length(features[i].position - features[other].position) > kTooClose * cell) continue;
      merged.join(i, other);
    }
  }
  return std::move(merged).roots();
}

void mark_merged(std::span<const std::size_t> before, std::span<const std::size_t> merged,
                 std::vector<std::uint8_t>* is_changed) {
  std::vector<std::uint8_t>& changed = *is_changed;
  for (std::size_t i = 0; i < merged.size(); ++i) {
    if (!before.empty() && before[i] != merged[i]) changed[i] = 1;
    if (changed[i] != 0) changed[merged[i]] = 1;
  }
  for (std::size_t i = 0; i < merged.size(); ++i) {
    if (changed[merged[i]] != 0) changed[i] = 1;
  }
}

std::vector<std::size_t> repeating_triangles(std::span<const Triangle> triangles,
                                             const Flags& is_flagged) {
  std::unordered_map<std::uint64_t, std::size_t> sides;
  std::vector<std::size_t> repeating;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t from = triangles[t][k];
      const std::int32_t to = triangles[t][(k + 1) % 3];
      if (!is_in(from, is_flagged) && !is_in(to, is_flagged)) continue;
      const std::uint64_t key =
          (static_cast<std::uint64_t>(from) << 32U) | static_cast<std::uint32_t>(to);
      const auto [found, is_new] = sides.try_emplace(key, t);
      if (!is_new) repeating.insert(repeating.end(), {found->second, t});
    }
  }
  return repeating;
}

std::vector<std::int32_t> pinched_vertices(std::span<const Triangle> triangles,
                                           const Flags& is_flagged) {
  std::unordered_map<std::int32_t, std::vector<std::array<std::int32_t, 2>>> links;
  for (const Triangle& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!is_in(triangle[k], is_flagged)) continue;
      links[triangle[k]].push_back({triangle[(k + 1) % 3], triangle[(k + 2) % 3]});
    }
  }
  std::vector<std::int32_t> pinched;
  for (const auto& [vertex, link] : links) {
    if (!is_circle(link)) pinched.push_back(vertex);
  }
  std::sort(pinched.begin(), pinched.end());
  return pinched;
}

bool unmerge(std::span<const Triangle> triangles, const LoopTriangles& made,
             std::span<const std::size_t> merged, std::vector<std::uint8_t>* is_single,
             std::vector<std::uint8_t>* is_changed) {
  const Flags is_shared = shared_vertices(made.places, merged);
  if (is_shared.empty()) return false;
  Flags is_faulty(merged.size(), 0);  // indexed by the first loop at each vertex
  for (const std::size_t t : repeating_triangles(triangles, is_shared)) {
    for (const std::int32_t owner : made.owners[t]) {
      if (owner >= 0) is_faulty[merged[static_cast<std::size_t>(owner)]] = 1;
    }
  }
  const std::vector<std::int32_t> pinched = pinched_vertices(triangles, is_shared);
  for (std::size_t i = 0; i < merged.size(); ++i) {
    if (std::binary_search(pinched.begin(), pinched.end(), made.places[i])) {
      is_faulty[merged[i]] = 1;
    }
  }
  bool is_any = false;
  for (std::size_t i = 0; i < merged.size(); ++i) {
    if (is_faulty[merged[i]] == 0) continue;
    is_any = is_any || (*is_single)[i] == 0;
    (*is_single)[i] = 1;
    (*is_changed)[i] = 1;
  }
  return is_any;
}

}  // namespace prefilter
