// SPDX-License-Identifier: GPL-3.0-or-later

// Cubes with suspects are bits by a hash: where two share one, only more triangles are looked at.
#include "prefilter/remesh/near_intersections.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "prefilter/remesh/intersections.h"

namespace prefilter {
namespace {

using Cube = std::array<std::int64_t, 3>;
using Corners = std::array<Vector3, 3>;

class CubeSet {
 public:
  CubeSet(double side, std::size_t count)
      : per_side_(1.0 / side),
        shift_(64 - std::max(10, static_cast<int>(std::bit_width(count)) + kBitsPerTriangle)),
        bits_((std::size_t{1} << (64 - shift_)) / 64, 0) {}

  void insert(const Corners& corners) {
    Cube low;
    Cube high;
    const double count = find_range(corners, &low, &high);
    if (!(count <= kMostCubes)) is_full_ = true;
    if (is_full_) return;
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const std::uint64_t bit = bit_of(x, y, z);
          bits_[bit / 64] |= std::uint64_t{1} << (bit % 64);
        }
      }
    }
  }

  bool meets(const Corners& corners) const {
    if (is_full_) return true;
    Cube low;
    Cube high;
    const double count = find_range(corners, &low, &high);
    if (count == 1.0) return has(low[0], low[1], low[2]);
    if (!(count <= kMostCubes)) return true;
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          if (has(x, y, z)) return true;
        }
      }
    }
    return false;
  }

 private:
  static constexpr int kBitsPerTriangle = 5;
  static constexpr double kMostCubes = 512.0;

  // The cubes that a triangle's box overlaps, and their number.
  double find_range(const Corners& corners, Cube* low, Cube* high) const {
    constexpr double kMost = 1e15;
    double count = 1.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double least = std::min({corners[0][a], corners[1][a], corners[2][a]});
      const double most = std::max({corners[0][a], corners[1][a], corners[2][a]});
      const double from = std::floor(std::max(least * per_side_, -kMost));
      const double to = std::floor(std::min(most * per_side_, kMost));
      (*low)[a] = static_cast<std::int64_t>(std::min(from, kMost));
      (*high)[a] = static_cast<std::int64_t>(std::max(to, -kMost));
      count *= to - from + 1.0;
    }
    return count;
  }

  bool has(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const std::uint64_t bit = bit_of(x, y, z);
    return ((bits_[bit / 64] >> (bit % 64)) & 1U) != 0;
  }

  std::uint64_t bit_of(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const std::uint64_t mixed = static_cast<std::uint64_t>(x) * 0x8DA6B343U +
                                static_cast<std::uint64_t>(y) * 0xD8163841U +
                                static_cast<std::uint64_t>(z) * 0xCB1AB31FU;
    return (mixed * 0x9E3779B97F4A7C15U) >> static_cast<unsigned>(shift_);
  }

  double per_side_;
  int shift_;
  std::vector<std::uint64_t> bits_;
  bool is_full_ = false;
};
}  // namespace

NearTriangles near_triangles(const MeshView<std::int32_t>& mesh, std::size_t first,
                             std::span<const std::uint8_t> is_suspect, double side) {
  std::size_t count = 0;
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    if (is_suspect[t] != 0 && mesh.triangles[t][0] >= 0) ++count;
  }
  NearTriangles near;
  if (count == 0) return near;
  // Where most are suspect, all are looked at.
  const bool is_any = 2 * count > mesh.triangles.size() - first;
  CubeSet cubes(side, is_any ? 0 : count);
  for (std::size_t t = first; t < mesh.triangles.size() && !is_any; ++t) {
    if (is_suspect[t] != 0 && mesh.triangles[t][0] >= 0) cubes.insert(mesh.corners(t));
  }
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    if (mesh.triangles[t][0] < 0) continue;
    if (!is_any && is_suspect[t] == 0 && !cubes.meets(mesh.corners(t))) continue;
    near.numbers.push_back(static_cast<std::uint32_t>(t));
  }
  near.triangles.reserve(near.numbers.size());
  near.is_suspect.reserve(near.numbers.size());
  for (const std::uint32_t t : near.numbers) {
    near.triangles.push_back(mesh.triangles[t]);
    near.is_suspect.push_back(is_suspect[t]);
  }
  return near;
}

std::vector<std::array<std::uint32_t, 2>> near_intersections(
    const MeshView<std::int32_t>& mesh, std::size_t first, std::span<const std::uint8_t> is_suspect,
    double side, const Progress& progress, int threads) {
  const NearTriangles near = near_triangles(mesh, first, is_suspect, side);
  std::vector<std::array<std::uint32_t, 2>> pairs =
      intersecting_triangles({mesh.positions, near.triangles}, near.is_suspect, progress, threads);
  for (auto& pair : pairs) {
    for (std::uint32_t& t : pair) t = near.numbers[t];
  }
  return pairs;
}

}  // namespace prefilter
