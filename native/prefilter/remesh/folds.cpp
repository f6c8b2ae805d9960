// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/remesh/folds.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace prefilter {
namespace {

// A side of a triangle, listed at the lower one of its ends.
struct Side {
  std::uint32_t other;
  std::uint32_t triangle;
};

// The sides of some triangles by their lower ends: those at v are from begins[v] to begins[v + 1].
struct SideTable {
  std::vector<std::uint32_t> begins;
  std::vector<Side> sides;
};

// Those from one touched vertex to another.
SideTable sides_of(const MeshView<std::int32_t>& mesh, std::size_t first,
                   std::span<const std::uint8_t> is_touched) {
  SideTable table;
  table.begins.assign(mesh.positions.size() + 1, 0);
  const auto visit = [&](const auto& add) {
    for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto a = static_cast<std::uint32_t>(mesh.triangles[t][k]);
        const auto b = static_cast<std::uint32_t>(mesh.triangles[t][(k + 1) % 3]);
        if (is_touched[a] != 0 && is_touched[b] != 0) add(std::min(a, b), std::max(a, b), t);
      }
    }
  };
  visit([&](std::uint32_t low, std::uint32_t, std::size_t) { ++table.begins[low + 1]; });
  std::partial_sum(table.begins.begin(), table.begins.end(), table.begins.begin());
  table.sides.resize(table.begins.back());
  std::vector<std::uint32_t> next(table.begins.begin(), table.begins.end() - 1);
  visit([&](std::uint32_t low, std::uint32_t high, std::size_t t) {
    table.sides[next[low]++] = {high, static_cast<std::uint32_t>(t)};
  });
  return table;
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> folded_pairs(const MeshView<std::int32_t>& mesh,
                                                       std::size_t first,
                                                       std::span<const std::uint8_t> is_suspect) {
  std::vector<std::uint8_t> is_touched(mesh.positions.size(), 0);
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    if (is_suspect[t] == 0) continue;
    for (const std::int32_t v : mesh.triangles[t]) is_touched[static_cast<std::size_t>(v)] = 1;
  }
  const SideTable table = sides_of(mesh, first, is_touched);
  const auto normal_of = [&](std::uint32_t t) {
    const auto [a, b, c] = mesh.corners(t);
    return cross(b - a, c - a);
  };
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (std::size_t v = 0; v + 1 < table.begins.size(); ++v) {
    for (std::uint32_t i = table.begins[v]; i < table.begins[v + 1]; ++i) {
      for (std::uint32_t j = i + 1; j < table.begins[v + 1]; ++j) {
        if (table.sides[i].other != table.sides[j].other) continue;
        const std::uint32_t t = table.sides[i].triangle;
        const std::uint32_t u = table.sides[j].triangle;
        if (is_suspect[t] == 0 && is_suspect[u] == 0) continue;
        const Vector3 a = normal_of(t);
        const Vector3 b = normal_of(u);
        if (dot(a, b) < kFold * std::sqrt(dot(a, a) * dot(b, b))) pairs.push_back({t, u});
      }
    }
  }
  return pairs;
}

}  // namespace prefilter
