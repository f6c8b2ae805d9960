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

struct CornersHash {
  std::size_t operator()(const std::array<std::int32_t, 3>& corners) const {
    std::uint64_t mixed = 0;
    for (const std::int32_t corner : corners) {
      mixed = (mixed ^ static_cast<std::uint32_t>(corner)) * 0x9E3779B97F4A7C15U;
      mixed ^= mixed >> 29U;
    }
    return static_cast<std::size_t>(mixed);
  }
};

// Of triangles on the same corners, the first.
struct Front {
  std::size_t row;
  bool is_even;
  bool is_sheet = false;
};

// The large triangles by their corners, which are in order.
class Fronts {
 public:
  void add(const std::array<std::int32_t, 3>& triangle, std::size_t row) {
    const auto [corners, is_even] = in_order(triangle);
    const auto [front, is_new] = fronts_.try_emplace(corners, Front{row, is_even});
    if (!is_new && front->second.is_even != is_even) front->second.is_sheet = true;
  }
  const Front& of(const std::array<std::int32_t, 3>& triangle) const {
    return fronts_.at(in_order(triangle).first);
  }

 private:
  static std::pair<std::array<std::int32_t, 3>, bool> in_order(
      const std::array<std::int32_t, 3>& triangle) {
    auto [a, b, c] = triangle;
    bool is_even = true;
    const auto order = [&](std::int32_t* low, std::int32_t* high) {
      if (*low <= *high) return;
      std::swap(*low, *high);
      is_even = !is_even;
    };
    order(&a, &b);
    order(&b, &c);
    order(&a, &b);
    return {{a, b, c}, is_even};
  }

  std::unordered_map<std::array<std::int32_t, 3>, Front, CornersHash> fronts_;
};

}  // namespace

Representatives find_representatives(const MeshView<std::int32_t>& mesh,
                                     std::span<const Vector3> normals,
                                     std::span<const std::uint32_t> triangles) {
  Representatives found;
  std::unordered_map<Place, std::size_t, PlaceHash> known;
  std::vector<double> areas;
  Fronts fronts;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!is_small(mesh.corners(triangles[i]))) fronts.add(mesh.triangles[triangles[i]], i);
  }
  std::vector<std::size_t> places(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t t = triangles[i];
    const auto corners = mesh.corners(t);
    const double area = triangle_area(corners);
    bool is_sheet = false;
    if (is_small(corners)) {
      const Place place = {cube_key(triangle_middle(corners), kSmall),
                           std::countr_zero(direction_bit(normals[t]))};
      const auto [same, is_new] = known.try_emplace(place, found.triangles.size());
      if (!is_new) {
        found.others.push_back({t, found.triangles[same->second], area, false});
        areas[same->second] += area;
        continue;
      }
    } else {
      const Front& front = fronts.of(mesh.triangles[t]);
      is_sheet = front.is_sheet;
      if (is_sheet && front.row != i) {
        found.others.push_back({t, triangles[front.row], area, true});
        areas[places[front.row]] += area;
        continue;
      }
    }
    places[i] = found.triangles.size();
    found.triangles.push_back(t);
    found.are_sheets.push_back(is_sheet);
    areas.push_back(area);
  }
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double own = triangle_area(mesh.corners(found.triangles[i]));
    found.shares.push_back(own > 0.0 ? areas[i] / own : 1.0);
  }
  return found;
}

}  // namespace prefilter
