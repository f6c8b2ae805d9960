// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/contour/near_intersections.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "prefilter/remesh/intersections.h"

namespace prefilter {
namespace {

// Calls visit(number) for the cubes that a triangle's box overlaps.
template <typename Visit>
void for_cubes(const std::array<Vector3, 3>& corners, double side, const Visit& visit) {
  constexpr std::int64_t kBias = std::int64_t{1} << 20;
  std::array<std::int64_t, 3> low;
  std::array<std::int64_t, 3> high;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [least, most] = std::minmax({corners[0][a], corners[1][a], corners[2][a]});
    low[a] = static_cast<std::int64_t>(std::floor(least / side)) + kBias;
    high[a] = static_cast<std::int64_t>(std::floor(most / side)) + kBias;
  }
  for (std::int64_t x = low[0]; x <= high[0]; ++x) {
    for (std::int64_t y = low[1]; y <= high[1]; ++y) {
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        visit((static_cast<std::uint64_t>(x) << 42U) | (static_cast<std::uint64_t>(y) << 21U) |
              static_cast<std::uint64_t>(z));
      }
    }
  }
}
}  // namespace

std::vector<std::array<std::uint32_t, 2>> near_intersections(
    const MeshView<std::int32_t>& mesh, std::size_t first, std::span<const std::uint8_t> is_suspect,
    double side, const Progress& progress, int threads) {
  std::unordered_set<std::uint64_t> cubes;
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    if (is_suspect[t] == 0) continue;
    for_cubes(mesh.corners(t), side, [&](std::uint64_t cube) { cubes.insert(cube); });
  }
  if (cubes.empty()) return {};
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::uint8_t> suspects;
  std::vector<std::uint32_t> numbers;
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    bool is_reached = is_suspect[t] != 0;
    if (!is_reached) {
      for_cubes(mesh.corners(t), side,
                [&](std::uint64_t cube) { is_reached = is_reached || cubes.contains(cube); });
    }
    if (!is_reached) continue;
    triangles.push_back(mesh.triangles[t]);
    suspects.push_back(is_suspect[t]);
    numbers.push_back(static_cast<std::uint32_t>(t));
  }
  std::vector<std::array<std::uint32_t, 2>> pairs =
      intersecting_triangles({mesh.positions, triangles}, suspects, progress, threads);
  for (auto& pair : pairs) {
    for (std::uint32_t& t : pair) t = numbers[t];
  }
  return pairs;
}

}  // namespace prefilter
