// SPDX-License-Identifier: GPL-3.0-or-later

// A binary bounding box tree over items in Morton order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/geometry.h"
#include "prefilter/geometry/spatial/morton.h"

namespace prefilter {

/// Nodes are ranges of the curve, split at boundaries of octree cells, so that boxes of points do
/// not overlap.
class BoxTree {
 public:
  struct Node {
    Box box;
    std::uint32_t begin;  // first item below the node
    std::uint32_t end;    // one past the last item
    std::uint32_t right;  // the second child, 0 for a leaf; the first child is the next node
  };

  BoxTree() = default;

  /// Builds a tree over items with these sorted Morton keys, fewer than 2^32. Leaves have at most
  /// `leaf_items` items. `box_of(item)` is the bounding box of an item.
  template <typename BoxOf>
  BoxTree(std::span<const std::uint64_t> keys, std::size_t leaf_items, const BoxOf& box_of,
          const Run& run);

  bool is_empty() const { return nodes_.empty(); }
  /// In preorder, starting with the root.
  std::span<const Node> nodes() const { return nodes_; }

  /// Visits leaves, roughly from near to far: calls `visit(node)` for a leaf if `may_be(squared,
  /// node)` holds for it and all its ancestors, where `squared` is the squared distance of the
  /// node's box from the point. Nodes are indices into `nodes()`.
  template <typename MayBe, typename Visit>
  void search(const Vector3& point, const MayBe& may_be, const Visit& visit) const;

  /// Calls `visit(node)` for the leaves whose boxes intersect this one.
  template <typename Visit>
  void for_overlapping(const Box& box, const Visit& visit) const;

 private:
  // The number of bits of a key, plus those of an index if all keys are equal.
  static constexpr std::size_t kMaxDepth = 3 * kMortonBits + 32;

  // Start of the second child of a node: at the first change of the highest differing bit of its
  // keys, or in the middle.
  static std::uint32_t split(std::span<const std::uint64_t> keys, std::uint32_t begin,
                             std::uint32_t end) {
    const std::uint64_t differing = keys[begin] ^ keys[end - 1];
    if (differing == 0) return begin + (end - begin) / 2;
    const std::uint64_t bit = std::bit_floor(differing);
    const auto part = keys.subspan(begin, end - begin);
    const auto first = std::partition_point(part.begin(), part.end(),
                                            [&](std::uint64_t key) { return (key & bit) == 0; });
    return begin + static_cast<std::uint32_t>(first - part.begin());
  }

  std::vector<Node> nodes_;
};

template <typename BoxOf>
BoxTree::BoxTree(std::span<const std::uint64_t> keys, std::size_t leaf_items, const BoxOf& box_of,
                 const Run& run) {
  if (keys.empty()) return;
  nodes_.reserve(4 * (keys.size() / leaf_items) + 1);
  struct Waiting {
    std::uint32_t begin;
    std::uint32_t end;
    std::uint32_t parent;
  };
  constexpr std::uint32_t kNoParent = std::numeric_limits<std::uint32_t>::max();
  std::array<Waiting, kMaxDepth> waiting;
  std::size_t count = 0;
  waiting[count++] = {0, static_cast<std::uint32_t>(keys.size()), kNoParent};
  CancelCheck cancel_check(run);
  while (count > 0) {
    auto [begin, end, parent] = waiting[--count];
    if (parent != kNoParent) nodes_[parent].right = static_cast<std::uint32_t>(nodes_.size());
    while (true) {
      cancel_check.step();
      nodes_.push_back({kEmptyBox, begin, end, 0});
      if (end - begin <= leaf_items) break;
      const std::uint32_t middle = split(keys, begin, end);
      waiting[count++] = {middle, end, static_cast<std::uint32_t>(nodes_.size() - 1)};
      end = middle;
    }
    Node& leaf = nodes_.back();
    for (std::uint32_t item = leaf.begin; item < leaf.end; ++item) leaf.box.include(box_of(item));
  }
  for (std::size_t node = nodes_.size(); node-- > 0;) {
    cancel_check.step();
    if (nodes_[node].right == 0) continue;
    nodes_[node].box = nodes_[node + 1].box;
    nodes_[node].box.include(nodes_[nodes_[node].right].box);
  }
}

template <typename MayBe, typename Visit>
void BoxTree::search(const Vector3& point, const MayBe& may_be, const Visit& visit) const {
  struct Waiting {
    std::size_t node;
    double squared;
  };
  std::array<Waiting, kMaxDepth> waiting;
  std::size_t count = 0;
  waiting[count++] = {0, nodes_[0].box.squared_distance(point)};
  while (count > 0) {
    auto [node, squared] = waiting[--count];
    while (may_be(squared, node)) {
      if (nodes_[node].right == 0) {
        visit(node);
        break;
      }
      const std::size_t right = nodes_[node].right;
      Waiting near = {node + 1, nodes_[node + 1].box.squared_distance(point)};
      Waiting far = {right, nodes_[right].box.squared_distance(point)};
      if (far.squared < near.squared) std::swap(near, far);
      waiting[count++] = far;
      node = near.node;
      squared = near.squared;
    }
  }
}

template <typename Visit>
void BoxTree::for_overlapping(const Box& box, const Visit& visit) const {
  if (nodes_.empty()) return;
  std::array<std::uint32_t, kMaxDepth> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t node = waiting[--count];
    if (!nodes_[node].box.overlaps(box)) continue;
    if (nodes_[node].right == 0) {
      visit(static_cast<std::size_t>(node));
      continue;
    }
    waiting[count++] = nodes_[node].right;
    waiting[count++] = node + 1;
  }
}

}  // namespace prefilter
