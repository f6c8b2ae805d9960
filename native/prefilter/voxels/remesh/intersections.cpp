// SPDX-License-Identifier: GPL-3.0-or-later

// Builds a tree of boxes over the triangles, and tests pairs of triangles whose boxes overlap.
#include "prefilter/voxels/remesh/intersections.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"
#include "prefilter/voxels/remesh/predicates.h"
#include "prefilter/voxels/remesh/triangle_pair.h"
#include "prefilter/voxels/remesh/triangle_tree.h"

namespace prefilter {
namespace {

constexpr std::int64_t kTestedTrianglesPerTask = 1 << 13;
constexpr std::int64_t kLeavesPerTask = 1 << 8;

using Mesh = MeshView<std::int32_t>;
using Pair = std::array<std::uint32_t, 2>;

// A triangle, by its leaf and its index in the leaf.
struct Suspect {
  std::size_t leaf;
  unsigned slot;
};

// Range of the coordinates' magnitudes, and bounding box.
struct Extent {
  Box box = kEmptyBox;
  double smallest = std::numeric_limits<double>::infinity();  // except 0
  double largest = 0.0;

  void include(const Vector3& point) {
    box.include(point);
    for (const double x : point) {
      const double size = std::abs(x);
      if (size > 0.0) smallest = std::min(smallest, size);
      largest = std::max(largest, size);
    }
  }
  void include(const Extent& other) {
    box.include(other.box);
    smallest = std::min(smallest, other.smallest);
    largest = std::max(largest, other.largest);
  }
};

// Extent of all positions, or of the triangles' corners if these are fewer.
Extent extent_of(const Mesh& mesh, const Run& run) {
  const bool is_small = 3 * mesh.triangles.size() < mesh.positions.size();
  const auto rows =
      static_cast<std::int64_t>(is_small ? mesh.triangles.size() : mesh.positions.size());
  std::vector<Extent> extents(static_cast<std::size_t>(range_count(rows, kTestedTrianglesPerTask)));
  parallel_ranges(rows, kTestedTrianglesPerTask, run, [&](std::int64_t begin, std::int64_t end) {
    Extent& extent = extents[static_cast<std::size_t>(begin / kTestedTrianglesPerTask)];
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      if (is_small) {
        for (const Vector3& corner : mesh.corners(i)) extent.include(corner);
      } else {
        extent.include(mesh.positions[i]);
      }
    }
  });
  Extent all;
  for (const Extent& extent : extents) all.include(extent);
  return all;
}

// Positions scaled by a power of two, with relatively tiny coordinates set to 0.
std::vector<Vector3> in_exact_range(std::span<const Vector3> positions, double largest) {
  int exponent = 0;
  std::frexp(largest, &exponent);
  std::vector<Vector3> scaled(positions.begin(), positions.end());
  for (Vector3& point : scaled) {
    for (double& x : point) {
      x = std::ldexp(x, -exponent);
      if (std::abs(x) < kSmallestExact) x = 0.0;
    }
  }
  return scaled;
}

Corners corners_of(const Mesh& mesh, const TriangleLeaf& leaf, std::size_t i) {
  const auto& [a, b, c] = leaf.vertices[i];
  return {{mesh.positions[static_cast<std::size_t>(a)], mesh.positions[static_cast<std::size_t>(b)],
           mesh.positions[static_cast<std::size_t>(c)]},
          leaf.vertices[i]};
}

// Appends the pairs of a suspect with triangles of another leaf, or of its own.
void find_pairs(const Mesh& mesh, const TriangleTree& tree, const Suspect& suspect,
                const FloatBox& box, const Corners& corners, std::size_t other_at,
                std::vector<Pair>* pairs) {
  const auto [at, i] = suspect;
  const TriangleLeaf& leaf = tree.leaves[at];
  const TriangleLeaf& other = tree.leaves[other_at];
  unsigned hits = other.overlap_mask(box) & ~other.degenerate;
  // A pair of two suspects is reported for the first one only.
  if (other_at < at) hits &= ~other.suspects;
  if (other_at == at) hits &= ~(other.suspects & ((2U << i) - 1U));
  for (; hits != 0; hits &= hits - 1U) {
    const auto k = static_cast<std::size_t>(std::countr_zero(hits));
    if (!do_intersect(corners, corners_of(mesh, other, k))) continue;
    const auto [low, high] = std::minmax(leaf.triangles[i], other.triangles[k]);
    pairs->push_back({low, high});
  }
}

// Appends the pairs of all suspects of a leaf.
void find_at(const Mesh& mesh, const TriangleTree& tree, std::size_t at, NearLeaves* near,
             std::vector<Pair>* pairs) {
  const TriangleLeaf& leaf = tree.leaves[at];
  if (leaf.suspects == 0) return;
  find_near(tree, at, near);
  for (unsigned i = 0; i < leaf.count; ++i) {
    const unsigned bit = 1U << i;
    if ((leaf.suspects & bit) == 0) continue;
    if ((leaf.degenerate & bit) != 0) {
      pairs->push_back({leaf.triangles[i], leaf.triangles[i]});
      continue;
    }
    const FloatBox box = leaf.box(i);
    const Corners corners = corners_of(mesh, leaf, i);
    for (std::size_t four = 0; four < near->boxes.size(); ++four) {
      for (unsigned hits = near->boxes[four].overlap_mask(box); hits != 0; hits &= hits - 1U) {
        const auto k = static_cast<std::size_t>(std::countr_zero(hits));
        find_pairs(mesh, tree, {at, i}, box, corners, near->leaves[4 * four + k], pairs);
      }
    }
  }
}

std::vector<Pair> find_all(const Mesh& mesh, const TriangleTree& tree, const Run& run) {
  const auto leaves = static_cast<std::int64_t>(tree.leaves.size());
  std::vector<std::vector<Pair>> lists(
      static_cast<std::size_t>(range_count(leaves, kLeavesPerTask)));
  const auto find_some = [&](std::int64_t begin, std::int64_t end) {
    std::vector<Pair>& pairs = lists[static_cast<std::size_t>(begin / kLeavesPerTask)];
    NearLeaves near;
    for (std::int64_t leaf = begin; leaf < end; ++leaf) {
      find_at(mesh, tree, static_cast<std::size_t>(leaf), &near, &pairs);
    }
  };
  const Stages stages(run, {19, 1});
  parallel_ranges(leaves, kLeavesPerTask, stages[0], find_some);
  std::vector<Pair> all;
  for (const std::vector<Pair>& pairs : lists) all.insert(all.end(), pairs.begin(), pairs.end());
  sort_in_parallel(&all, stages[1]);
  return all;
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> intersecting_triangles(
    const MeshView<std::int32_t>& mesh, std::span<const std::uint8_t> is_suspect, const Run& run) {
  if (mesh.triangles.empty()) return {};
  const Extent extent = extent_of(mesh, run.part(0.0, 0.05));
  if (extent.largest > kLargestExact || extent.smallest < kSmallestExact) {
    const std::vector<Vector3> scaled = in_exact_range(mesh.positions, extent.largest);
    return intersecting_triangles({scaled, mesh.triangles}, is_suspect, run.part(0.05, 1.0));
  }
  const TriangleTree tree = build_tree(mesh, is_suspect, extent.box, run.part(0.05, 0.3));
  return find_all(mesh, tree, run.part(0.3, 1.0));
}

}  // namespace prefilter
