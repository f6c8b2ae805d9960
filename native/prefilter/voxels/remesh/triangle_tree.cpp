// SPDX-License-Identifier: GPL-3.0-or-later

// Built along a Morton curve (C. Lauterbach and others, Fast BVH construction on GPUs, 2009), with
// the triangles grouped by size first.
#include "prefilter/voxels/remesh/triangle_tree.h"

#include <bit>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"
#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/voxels/remesh/predicates.h"

namespace prefilter {
namespace {

constexpr std::int64_t kTreeTrianglesPerTask = 1 << 13;

using Mesh = MeshView<std::int32_t>;

// Maps positions to floats in [0, 1] relative to the mesh's box.
struct Frame {
  Vector3 low;
  double factor;

  FloatBox box_of(const std::array<Vector3, 3>& corners) const {
    FloatBox box;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [least, most] = std::minmax({corners[0][a], corners[1][a], corners[2][a]});
      box.low[a] = static_cast<float>((least - low[a]) * factor);
      box.high[a] = static_cast<float>((most - low[a]) * factor);
    }
    return box;
  }
};

float size_of(const FloatBox& box) {
  return std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
}

// Sort key: one of four size classes, then the index along the Morton curve.
std::uint64_t key_of(const FloatBox& box, float mean) {
  constexpr int kBits = 10;
  std::uint64_t key = 0;
  for (float most = 4.0F * mean; key < 3 && size_of(box) > most; most *= 8.0F) ++key;
  key <<= 3U * kBits;
  for (std::size_t a = 0; a < 3; ++a) {
    const float middle = 0.5F * (box.low[a] + box.high[a]);
    const float cell = std::clamp(middle * (1 << kBits), 0.0F, (1 << kBits) - 1.0F);
    key |= spread_bits(static_cast<std::uint64_t>(cell)) << a;
  }
  return key;
}

// Sorted keys, with the key in the upper half of each number and the triangle in the lower.
std::vector<std::uint64_t> sorted_keys(const Mesh& mesh, const Frame& frame, const Run& run) {
  const auto rows = static_cast<std::int64_t>(mesh.triangles.size());
  const auto tasks = static_cast<std::size_t>(range_count(rows, kTreeTrianglesPerTask));
  std::vector<double> sums(tasks);
  const auto measure = [&](std::int64_t begin, std::int64_t end) {
    double sum = 0.0;
    for (std::int64_t t = begin; t < end; ++t) {
      sum += size_of(frame.box_of(mesh.corners(static_cast<std::size_t>(t))));
    }
    sums[static_cast<std::size_t>(begin / kTreeTrianglesPerTask)] = sum;
  };
  const Stages stages(run, {12, 13, 75});
  parallel_ranges(rows, kTreeTrianglesPerTask, stages[0], measure);
  double mean = 0.0;
  for (const double sum : sums) mean += sum;
  mean /= static_cast<double>(rows);

  std::vector<std::uint64_t> keys(mesh.triangles.size());
  const auto place = [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t t = begin; t < end; ++t) {
      const FloatBox box = frame.box_of(mesh.corners(static_cast<std::size_t>(t)));
      keys[static_cast<std::size_t>(t)] =
          key_of(box, static_cast<float>(mean)) << 32U | static_cast<std::uint64_t>(t);
    }
  };
  parallel_ranges(rows, kTreeTrianglesPerTask, stages[1], place);
  sort_in_parallel(&keys, stages[2]);
  return keys;
}

void make_leaf(const Mesh& mesh, std::span<const std::uint8_t> is_suspect, const Frame& frame,
               std::span<const std::uint64_t> keys, TriangleLeaf* leaf) {
  for (std::size_t i = 0; i < TriangleLeaf::kTriangles; ++i) {
    if (i >= keys.size()) {
      leaf->boxes[i / 4].set(i % 4, FloatBox());
      continue;
    }
    const auto triangle = static_cast<std::uint32_t>(keys[i]);
    const std::array<Vector3, 3> corners = mesh.corners(triangle);
    leaf->boxes[i / 4].set(i % 4, frame.box_of(corners));
    leaf->triangles[i] = triangle;
    leaf->vertices[i] = mesh.triangles[triangle];
    if (is_suspect.empty() || is_suspect[triangle] != 0) leaf->suspects |= 1U << i;
    if (are_collinear(corners[0], corners[1], corners[2])) leaf->degenerate |= 1U << i;
    ++leaf->count;
  }
}

std::vector<TriangleLeaf> make_leaves(const Mesh& mesh, std::span<const std::uint8_t> is_suspect,
                                      const Frame& frame, std::span<const std::uint64_t> keys,
                                      const Run& run) {
  constexpr std::size_t kEach = TriangleLeaf::kTriangles;
  std::vector<TriangleLeaf> leaves((keys.size() + kEach - 1) / kEach);
  const auto fill = [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const auto leaf = static_cast<std::size_t>(i);
      const std::size_t first = leaf * kEach;
      const std::size_t count = std::min(kEach, keys.size() - first);
      make_leaf(mesh, is_suspect, frame, keys.subspan(first, count), &leaves[leaf]);
    }
  };
  parallel_ranges(static_cast<std::int64_t>(leaves.size()), kTreeTrianglesPerTask / 8, run, fill);
  return leaves;
}

std::vector<TriangleLevel> make_levels(std::span<const TriangleLeaf> leaves, const Run& run) {
  std::vector<FloatBox> boxes(leaves.size());
  std::vector<std::uint8_t> has_others(leaves.size());
  const auto count = static_cast<std::int64_t>(leaves.size());
  const auto make_some = [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const TriangleLeaf& leaf = leaves[i];
      for (unsigned k = 0; k < leaf.count; ++k) boxes[i].include(leaf.box(k));
      has_others[i] = static_cast<unsigned>(std::popcount(leaf.suspects)) < leaf.count ? 1 : 0;
    }
  };
  parallel_ranges(count, kTreeTrianglesPerTask, run, make_some);
  std::vector<TriangleLevel> levels;
  while (true) {
    const std::size_t above =
        (boxes.size() + TriangleTree::kChildren - 1) / TriangleTree::kChildren;
    std::vector<FloatBox> boxes_above(above);
    std::vector<std::uint8_t> has_others_above(above);
    TriangleLevel level;
    level.boxes.resize(above);
    for (std::size_t i = 0; i < above * TriangleTree::kChildren; ++i) {
      const FloatBox box = i < boxes.size() ? boxes[i] : FloatBox();
      level.boxes[i / TriangleTree::kChildren].set(i % TriangleTree::kChildren, box);
      if (i >= boxes.size()) continue;
      boxes_above[i / TriangleTree::kChildren].include(box);
      has_others_above[i / TriangleTree::kChildren] |= has_others[i];
    }
    level.has_others = std::move(has_others);
    levels.push_back(std::move(level));
    if (above == 1) return levels;
    boxes = std::move(boxes_above);
    has_others = std::move(has_others_above);
  }
}
}  // namespace

TriangleTree build_tree(const Mesh& mesh, std::span<const std::uint8_t> is_suspect, const Box& box,
                        const Run& run) {
  double size = 0.0;
  for (int a = 0; a < 3; ++a) size = std::max(size, box.size(a));
  const Frame frame = {box.low, size > 0.0 ? 1.0 / size : 1.0};
  const Stages stages(run, {16, 4, 5});
  const std::vector<std::uint64_t> keys = sorted_keys(mesh, frame, stages[0]);
  TriangleTree tree;
  tree.leaves = make_leaves(mesh, is_suspect, frame, keys, stages[1]);
  tree.levels = make_levels(tree.leaves, stages[2]);
  return tree;
}

void find_near(const TriangleTree& tree, std::size_t leaf, NearLeaves* near) {
  near->clear();
  const FloatBox box = tree.box(leaf);
  struct Waiting {
    std::size_t level;
    std::size_t four;
  };
  // At most four per level, and 16 levels for 2^32 triangles.
  std::array<Waiting, 64> waiting;
  std::size_t count = 0;
  waiting[count++] = {tree.levels.size() - 1, 0};
  while (count > 0) {
    const auto [at, four] = waiting[--count];
    const TriangleLevel& level = tree.levels[at];
    const FourBoxes& boxes = level.boxes[four];
    for (unsigned hits = boxes.overlap_mask(box); hits != 0; hits &= hits - 1U) {
      const auto k = static_cast<std::size_t>(std::countr_zero(hits));
      const std::size_t node = four * TriangleTree::kChildren + k;
      if (level.has_others[node] == 0 && ((node + 1) << (2 * at)) <= leaf) continue;
      if (at == 0) {
        near->add(node, boxes.box(k));
      } else {
        waiting[count++] = {at - 1, node};
      }
    }
  }
}

}  // namespace prefilter
