// SPDX-License-Identifier: GPL-3.0-or-later

// Marks cubes with suspects in a hashed bitmap; collisions only cause additional tests. Consecutive
// triangles are often close together, so runs of them are tested individually only if larger cubes
// around the whole run contain suspects.
//
// If all normals in a cube are within 60 degrees of one of them, the mesh does not intersect itself
// there. Proof sketch: the mesh was made, piece by piece with the same borders, from one that does
// not. Projected along that direction all triangles of a piece have the same orientation, so none
// covers another. Between two sheets that face the same way lies one that faces the other way, and
// it is in the cube, too.
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

constexpr std::size_t kTrianglesPerRun = 32;  // triangles tested as a run
constexpr double kLargeCubeSides = 4.0;       // side of the cubes for runs, in sides

using Cube = std::array<std::int64_t, 3>;
using CornerPoints = std::array<Vector3, 3>;

// Hashes the cubes of a grid to a given number of bits.
class Cubes {
 public:
  static constexpr double kMaxCubesPerTriangle = 512.0;  // a triangle in more counts as near all

  Cubes(double side, int bits) : per_side_(1.0 / side), shift_(64 - bits) {}

  // Calls visit(hash) for the cubes that overlap a triangle's box, enlarged by `margin` sides,
  // until it returns true. Returns whether it did, or whether there are too many cubes.
  template <typename Visit>
  bool any_of(const CornerPoints& corners, const Visit& visit, double margin = 0.0) const {
    Cube low;
    Cube high;
    const double count = find_range(corners, margin, &low, &high);
    if (count == 1.0) return visit(hash_of(low[0], low[1], low[2]));
    if (!(count <= kMaxCubesPerTriangle)) return true;
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
  // Range of the cubes that overlap a triangle's box, and their number.
  double find_range(const CornerPoints& corners, double margin, Cube* low, Cube* high) const {
    constexpr double kMost = 1e15;  // exact as integers and as doubles
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

  bool overlaps(const CornerPoints& corners) const {
    return is_full_ || cubes_.any_of(corners, [&](std::size_t hash) {
      return ((bits_[hash / 64] >> (hash % 64)) & 1U) != 0;
    });
  }

 private:
  static constexpr int kMoreBits = 5;  // 32 bits per triangle, so that few collide

  Cubes cubes_;
  std::vector<std::uint64_t> bits_;
  bool is_full_ = false;
};

// Records for each cube whether all normals in it are close to the first one.
class NormalCubes {
 public:
  NormalCubes(double side, std::size_t count)
      : cubes_(side, bits_for(count, kMoreBits)),
        firsts_(std::size_t{1} << bits_for(count, kMoreBits)) {}

  void add(const CornerPoints& corners) {
    constexpr float kMinSimilarCosine = 0.51F;  // cosine
    const Normal n = normal_of(corners);
    has_large_ |= cubes_.any_of(corners, [&](std::size_t hash) {
      Normal& first_normal = firsts_[hash];
      if (first_normal == Normal{}) first_normal = n;
      const float cosine = n[0] * first_normal[0] + n[1] * first_normal[1] + n[2] * first_normal[2];
      if (!(cosine > kMinSimilarCosine)) first_normal[0] = kRough;
      return false;
    });
  }

  // Call after all triangles were added.
  bool is_rough_at(const CornerPoints& corners) const {
    // Margin for how far a sheet between two others may have moved since.
    constexpr double kMargin = 0.25;
    const auto is_rough = [&](std::size_t hash) { return firsts_[hash][0] == kRough; };
    return has_large_ || cubes_.any_of(corners, is_rough, kMargin);
  }

 private:
  static constexpr int kMoreBits = 0;
  static constexpr float kRough = std::numeric_limits<float>::infinity();
  using Normal = std::array<float, 3>;

  // The normal of length 1; 0 for triangles without area.
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

// Three points with the same bounding box as triangles [begin, end), except removed ones.
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

std::vector<std::uint8_t> keep_rough_suspects(const MeshView<std::int32_t>& mesh, std::size_t first,
                                              std::vector<std::uint8_t> is_suspect, double side,
                                              const Run& run) {
  // The filter takes about as long as testing a tenth of the triangles.
  constexpr std::size_t kTrianglesPerSuspect = 10;
  const auto suspects = static_cast<std::size_t>(
      std::count_if(is_suspect.begin() + static_cast<std::ptrdiff_t>(first), is_suspect.end(),
                    [](std::uint8_t flag) { return flag != 0; }));
  if (kTrianglesPerSuspect * suspects < mesh.triangles.size() - first) return is_suspect;
  NormalCubes cubes(side, mesh.triangles.size() - first);
  CancelCheck cancel_check(run);
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
                             const Run& run) {
  std::size_t count = 0;
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    if (is_suspect[t] != 0 && mesh.triangles[t][0] >= 0) ++count;
  }
  NearTriangles near;
  if (count == 0) return near;
  // If most triangles are suspect, test all.
  const bool is_any = 2 * count > mesh.triangles.size() - first;
  CubeSet cubes(side, is_any ? 0 : count);
  CubeSet large_cubes(kLargeCubeSides * side, is_any ? 0 : count);
  CancelCheck cancel_check(run);
  for (std::size_t t = first; t < mesh.triangles.size() && !is_any; ++t) {
    cancel_check.step();
    if (is_suspect[t] == 0 || mesh.triangles[t][0] < 0) continue;
    cubes.insert(mesh.corners(t));
    large_cubes.insert(mesh.corners(t));
  }
  for (std::size_t begin = first; begin < mesh.triangles.size(); begin += kTrianglesPerRun) {
    const std::size_t end = std::min(begin + kTrianglesPerRun, mesh.triangles.size());
    if (!is_any && !large_cubes.overlaps(corners_of_box(mesh, begin, end))) continue;
    for (std::size_t t = begin; t < end; ++t) {
      cancel_check.step();
      if (mesh.triangles[t][0] < 0) continue;
      if (!is_any && is_suspect[t] == 0 && !cubes.overlaps(mesh.corners(t))) continue;
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
    double side, const Run& run) {
  const NearTriangles near = near_triangles(mesh, first, is_suspect, side, run);
  std::vector<std::array<std::uint32_t, 2>> pairs =
      intersecting_triangles({mesh.positions, near.triangles}, near.is_suspect, run);
  for (auto& pair : pairs) {
    for (std::uint32_t& t : pair) t = near.numbers[t];
  }
  return pairs;
}

}  // namespace prefilter
