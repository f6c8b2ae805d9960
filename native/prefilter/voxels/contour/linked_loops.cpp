// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/linked_loops.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/voxels/contour/source_regions.h"

namespace prefilter {
namespace {

constexpr double kRidgeReach = 1.5;  // cells
constexpr std::int64_t kLinkedLoopsPerTask = 64;

// The two loops at a side; -1: none.
using LoopPair = std::array<std::int32_t, 2>;

std::uint64_t key_of(std::int32_t a, std::int32_t b) {
  const auto [low, high] = std::minmax(a, b);
  return (static_cast<std::uint64_t>(low) << 32U) | static_cast<std::uint32_t>(high);
}

std::uint64_t side_key(const SharpLoop& loop, std::size_t side) {
  return key_of(loop.from(side), loop.to(side));
}

// The loops at each divided side.
std::unordered_map<std::uint64_t, LoopPair> loops_of_sides(const LinkedLoops& linked) {
  std::unordered_map<std::uint64_t, LoopPair> pairs;
  for (std::size_t i = 0; i < linked.size(); ++i) {
    for (std::size_t k = 0; k < linked.side_count(i); ++k) {
      if (!linked.sides[i][k].is_divided) continue;
      const auto self = static_cast<std::int32_t>(i);
      const auto [found, is_new] =
          pairs.try_emplace(side_key(linked.loops[i], k), LoopPair{self, -1});
      if (!is_new) found->second[1] = self;
    }
  }
  return pairs;
}

void find_joints(LinkedLoops* linked) {
  const std::unordered_map<std::uint64_t, LoopPair> pairs = loops_of_sides(*linked);
  std::unordered_map<std::uint64_t, int> counts;  // number of sides that two loops share
  for (const auto& [key, loops] : pairs) {
    if (loops[1] >= 0) ++counts[key_of(loops[0], loops[1])];
  }
  for (std::size_t i = 0; i < linked->size(); ++i) {
    const auto self = static_cast<std::int32_t>(i);
    for (std::size_t k = 0; k < linked->side_count(i); ++k) {
      LoopSide& side = linked->sides[i][k];
      if (!side.is_divided) continue;
      const LoopPair& loops = pairs.at(side_key(linked->loops[i], k));
      const std::int32_t other = loops[0] == self ? loops[1] : loops[0];
      if (other < 0 || other == self || counts[key_of(self, other)] != 1) continue;
      side.other = other;
    }
  }
}

// A diagonal between vertices shared by loops of two dual cells is reserved for the first loop.
void find_shared(LinkedLoops* linked) {
  std::vector<std::array<std::int32_t, 2>> corners;  // vertex and loop
  for (std::size_t i = 0; i < linked->size(); ++i) {
    for (std::size_t k = 0; k < linked->side_count(i); ++k) {
      corners.push_back({linked->loops[i].from(k), static_cast<std::int32_t>(i)});
    }
  }
  std::sort(corners.begin(), corners.end());
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const auto [vertex, number] = corners[c];
    const auto i = static_cast<std::size_t>(number);
    const SharpLoop& loop = linked->loops[i];
    const auto begin = loop.corners.begin();
    const auto own = static_cast<std::size_t>(std::find(begin, begin + loop.count, vertex) - begin);
    for (std::size_t before = c; before > 0 && corners[before - 1][0] == vertex; --before) {
      const SharpLoop& earlier = linked->loops[static_cast<std::size_t>(corners[before - 1][1])];
      const auto end = earlier.corners.begin() + earlier.count;
      for (std::size_t k = 0; k < linked->side_count(i); ++k) {
        if (k == own || std::find(earlier.corners.begin(), end, loop.from(k)) == end) continue;
        linked->sides[i][own].shared |= static_cast<std::uint16_t>(1U << k);
      }
    }
  }
}
}  // namespace

std::vector<std::size_t> LinkedLoops::joined(std::size_t loop,
                                             std::span<const std::uint8_t> is_sharp) const {
  std::vector<std::size_t> others;
  for (std::size_t k = 0; k < side_count(loop); ++k) {
    if (!is_joined(loop, k, is_sharp)) continue;
    others.push_back(static_cast<std::size_t>(sides[loop][k].other));
  }
  return others;
}

bool are_divided(const FeatureSurface& surface, const VertexSamples& samples, std::int32_t a,
                 std::int32_t b) {
  const SourcePoint* p = samples.of(a);
  const SourcePoint* q = samples.of(b);
  if (p == nullptr || q == nullptr) return false;
  if (p->label != q->label) return true;
  if (dot(p->normal, q->normal) >= kSharpCosine) return false;
  const Vector3 middle = 0.5 * (p->position + q->position);
  return surface.nearest_border(middle, kRidgeReach * surface.cell(), p->label, p->label)
      .has_value();
}

LinkedLoops link_loops(std::vector<SharpLoop> loops, const FeatureSurface& surface,
                       const VertexSamples& samples, const Run& run) {
  LinkedLoops linked{std::move(loops), {}};
  linked.sides.resize(linked.size());
  const auto find_some = [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      for (std::size_t k = 0; k < linked.side_count(i); ++k) {
        linked.sides[i][k].is_divided =
            are_divided(surface, samples, linked.loops[i].from(k), linked.loops[i].to(k));
      }
    }
  };
  parallel_ranges(static_cast<std::int64_t>(linked.size()), kLinkedLoopsPerTask, run, find_some);
  find_joints(&linked);
  find_shared(&linked);
  return linked;
}

}  // namespace prefilter
