// SPDX-License-Identifier: GPL-3.0-or-later

// Cubes with suspects are bits by a hash: where two share one, only more triangles are looked at.
// Of triangles that follow each other many lie together: these are looked at one by one only where
// larger cubes around all of them have suspects.
//
// Where all normals in a cube are within 60 degrees of one of them a mesh does not meet itself.
// It came, piece by piece with the same borders, of one that does not: seen along that direction
// each piece has all of its triangles one way around, so that none covers another. Two sheets that
// face the same way have one between them that does not, which is in the cube, too.
#include "prefilter/voxels/remesh/near_intersections.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "prefilter/base/cancel_check.h"
#include "prefilter/voxels/remesh/intersections.h"

namespace prefilter {
namespace {

constexpr std::size_t kRun = 32;    // triangles
constexpr double kLargeSide = 4.0;  // of cubes for runs, in sides

using Cube = std::array<std::int64_t, 3>;
using CornerPoints = std::array<Vector3, 3>;

// Cubes of this side, by a hash of so many bits.
class Cubes {
 public:
  static constexpr double kMostCubes = 512.0;

  Cubes(double side, int bits) : per_side_(1.0 / side), shift_(64 - bits) {}

  // Calls visit(hash) for the cubes that a triangle's box overlaps, with a margin of so many sides,
  // until that returns true. Returns whether it did, or there are too many.
  template <typename Visit>
  bool any_of(const CornerPoints& corners, const Visit& visit, double margin = 0.0) const {
    Cube low;
    Cube high;
    const double count = find_range(corners, margin, &low, &high);
    if (count == 1.0) return visit(hash_of(low[0], low[1], low[2]));
    if (!(count <= kMostCubes)) return true;
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          if (visit(hash_of(x, y, z))) return true;
        }
      }
    }
    return false;
  }

 private:
  // The cubes that a triangle's box overlaps, and their number.
  double find_range(const CornerPoints& corners, double margin, Cube* low, Cube* high) const {
    constexpr double kMost = 1e15;
    double count = 1.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double least = std::min({corners[0][a], corners[1][a], corners[2][a]});
      const double most = std::max({corners[0][a], corners[1][a], corners[2][a]});
      const double from = std::floor(std::max(least * per_side_ - margin, -kMost));
      const double to = std::floor(std::min(most * per_side_ + margin, kMost));
      (*low)[a] = static_cast<std::int64_t>(std::min(from, kMost));
      (*high)[a] = static_cast<std::int64_t>(std::max(to, -kMost));
      count *= to - from + 1.0;
    }
    return count;
  }

  std::size_t hash_of(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const std::uint64_t mixed = static_cast<std::uint64_t>(x) * 0x8DA6B343U +
                                static_cast<std::uint64_t>(y) * 0xD8163841U +
                                static_cast<std::uint64_t>(z) * 0xCB1AB31FU;
    return static_cast<std::size_t>((mixed * 0x9E3779B97F4A7C15U) >> static_cast<unsigned>(shift_));
  }

  double per_side_;
  int shift_;
};

int bits_for(std::size_t count, int more) {
  return std::max(14, static_cast<int>(std::bit_width(count)) + more);
}

class CubeSet {
 public:
  CubeSet(double side, std::size_t count)
      : cubes_(side, bits_for(count, kMoreBits)),
        bits_((std::size_t{1} << bits_for(count, kMoreBits)) / 64, 0) {}

  void insert(const CornerPoints& corners) {
    is_full_ = is_full_ || cubes_.any_of(corners, [&](std::size_t hash) {
      bits_[hash / 64] |= std::uint64_t{1} << (hash % 64);
      return false;
    });
  }

  bool meets(const CornerPoints& corners) const {
    return is_full_ || cubes_.any_of(corners, [&](std::size_t hash) {
      return ((bits_[hash / 64] >> (hash % 64)) & 1U) != 0;
    });
  }

 private:
  static constexpr int kMoreBits = 5;

  Cubes cubes_;
  std::vector<std::uint64_t> bits_;
  bool is_full_ = false;
};

// Cubes, and whether the normals of what is in them are all close to the first one.
class NormalCubes {
 public:
  NormalCubes(double side, std::size_t count)
      : cubes_(side, bits_for(count, kMoreBits)),
        firsts_(std::size_t{1} << bits_for(count, kMoreBits)) {}

  void add(const CornerPoints& corners) {
    constexpr float kLeast = 0.51F;  // cosine
    const Normal n = normal_of(corners);
    has_large_ |= cubes_.any_of(corners, [&](std::size_t hash) {
      Normal& one = firsts_[hash];
      if (one == Normal{}) one = n;
      const float cosine = n[0] * one[0] + n[1] * one[1] + n[2] * one[2];
      if (!(cosine > kLeast)) one[0] = kRough;
      return false;
    });
  }

  // Once all are added.
  bool is_rough_at(const CornerPoints& corners) const {
    // As far as what was between two sheets may have moved since.
    constexpr double kMargin = 0.25;
    const auto is_rough = [&](std::size_t hash) { return firsts_[hash][0] == kRough; };
    return has_large_ || cubes_.any_of(corners, is_rough, kMargin);
  }

 private:
  static constexpr int kMoreBits = 0;
  static constexpr float kRough = std::numeric_limits<float>::infinity();
  using Normal = std::array<float, 3>;

  // Of length 1; 0 for what is none.
  static Normal normal_of(const CornerPoints& corners) {
    const Vector3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double size = length(normal);
    if (!(size > 0.0)) return {};
    return {static_cast<float>(normal[0] / size), static_cast<float>(normal[1] / size),
            static_cast<float>(normal[2] / size)};
  }

  Cubes cubes_;
  std::vector<Normal> firsts_;
  bool has_large_ = false;
};

// Three points that have the same box as the triangles from one to another, without those that are
// gone.
CornerPoints corners_of_box(const MeshView<std::int32_t>& mesh, std::size_t begin,
                            std::size_t end) {
  Box box = kEmptyBox;
  for (std::size_t t = begin; t < end; ++t) {
    if (mesh.triangles[t][0] < 0) continue;
    for (const Vector3& corner : mesh.corners(t)) box.include(corner);
  }
  return {box.low, box.high, box.high};
}
}  // namespace

std::vector<std::uint8_t> where_rough(const MeshView<std::int32_t>& mesh, std::size_t first,
                                      std::vector<std::uint8_t> is_suspect, double side,
                                      const Progress& progress) {
  // The rest takes about as long as a tenth of the suspects.
  constexpr std::size_t kFew = 10;
  const auto suspects = static_cast<std::size_t>(
      std::count_if(is_suspect.begin() + static_cast<std::ptrdiff_t>(first), is_suspect.end(),
                    [](std::uint8_t flag) { return flag != 0; }));
  if (kFew * suspects < mesh.triangles.size() - first) return is_suspect;
  NormalCubes cubes(side, mesh.triangles.size() - first);
  CancelCheck cancel_check(progress);
  const auto visit = [&](const auto& work) {
    for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
      cancel_check.step();
      if (mesh.triangles[t][0] >= 0) work(t, mesh.corners(t));
    }
  };
  visit([&](std::size_t, const CornerPoints& corners) { cubes.add(corners); });
  visit([&](std::size_t t, const CornerPoints& corners) {
    if (is_suspect[t] != 0 && !cubes.is_rough_at(corners)) is_suspect[t] = 0;
  });
  return is_suspect;
}

NearTriangles near_triangles(const MeshView<std::int32_t>& mesh, std::size_t first,
                             std::span<const std::uint8_t> is_suspect, double side,
                             const Progress& progress) {
  std::size_t count = 0;
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    if (is_suspect[t] != 0 && mesh.triangles[t][0] >= 0) ++count;
  }
  NearTriangles near;
  if (count == 0) return near;
  // Where most are suspect, all are looked at.
  const bool is_any = 2 * count > mesh.triangles.size() - first;
  CubeSet cubes(side, is_any ? 0 : count);
  CubeSet large_cubes(kLargeSide * side, is_any ? 0 : count);
  CancelCheck cancel_check(progress);
  for (std::size_t t = first; t < mesh.triangles.size() && !is_any; ++t) {
    cancel_check.step();
    if (is_suspect[t] == 0 || mesh.triangles[t][0] < 0) continue;
    cubes.insert(mesh.corners(t));
    large_cubes.insert(mesh.corners(t));
  }
  for (std::size_t begin = first; begin < mesh.triangles.size(); begin += kRun) {
    const std::size_t end = std::min(begin + kRun, mesh.triangles.size());
    if (!is_any && !large_cubes.meets(corners_of_box(mesh, begin, end))) continue;
    for (std::size_t t = begin; t < end; ++t) {
      cancel_check.step();
      if (mesh.triangles[t][0] < 0) continue;
      if (!is_any && is_suspect[t] == 0 && !cubes.meets(mesh.corners(t))) continue;
      near.numbers.push_back(static_cast<std::uint32_t>(t));
    }
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
  const NearTriangles near = near_triangles(mesh, first, is_suspect, side, progress);
  std::vector<std::array<std::uint32_t, 2>> pairs =
      intersecting_triangles({mesh.positions, near.triangles}, near.is_suspect, progress, threads);
  for (auto& pair : pairs) {
    for (std::uint32_t& t : pair) t = near.numbers[t];
  }
  return pairs;
}

}  // namespace prefilter
