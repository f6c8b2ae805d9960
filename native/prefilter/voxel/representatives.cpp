// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxel/representatives.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <unordered_map>

#include "prefilter/spatial/triangle_pieces.h"
#include "prefilter/voxel/cube_keys.h"
#include "prefilter/voxel/opposed_bricks.h"

namespace prefilter {
namespace {

constexpr double kSmall = 0.25;  // cells

struct Place {
  std::uint64_t cube;
  int direction;

  bool operator==(const Place& other) const = default;
};

struct PlaceHash {
  std::size_t operator()(const Place& place) const {
    const std::uint64_t mixed =
        place.cube * 0x9E3779B97F4A7C15U + static_cast<std::uint64_t>(place.direction);
    return static_cast<std::size_t>((mixed ^ (mixed >> 29U)) * 0xBF58476D1CE4E5B9U);
  }
};

bool is_small(const std::array<Vector3, 3>& p) {
  return std::max({length(p[1] - p[0]), length(p[2] - p[1]), length(p[0] - p[2])}) <= kSmall;
}

}  // namespace

Representatives find_representatives(const MeshView<std::int32_t>& mesh,
                                     std::span<const Vector3> normals,
                                     std::span<const std::uint32_t> triangles) {
  Representatives found;
  std::unordered_map<Place, std::size_t, PlaceHash> known;
  std::vector<double> areas;
  for (const std::uint32_t t : triangles) {
    const auto corners = mesh.corners(t);
    const double area = triangle_area(corners);
    if (is_small(corners)) {
      const Place place = {cube_key(triangle_middle(corners), kSmall),
                           std::countr_zero(direction_bit(normals[t]))};
      const auto [same, is_new] = known.try_emplace(place, found.triangles.size());
      if (!is_new) {
        found.others.push_back({t, found.triangles[same->second], area});
        areas[same->second] += area;
        continue;
      }
    }
    found.triangles.push_back(t);
    areas.push_back(area);
  }
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double own = triangle_area(mesh.corners(found.triangles[i]));
    found.shares.push_back(own > 0.0 ? areas[i] / own : 1.0);
  }
  return found;
}

}  // namespace prefilter
