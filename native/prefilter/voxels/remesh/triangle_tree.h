// SPDX-License-Identifier: GPL-3.0-or-later

// A bounding volume hierarchy over triangles, with four children per node.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/base/vectors.h"

namespace prefilter {

/// Rounding positions to floats is monotonic, so boxes that overlap still do.
struct FloatBox {
  std::array<float, 3> low = {kInfinity, kInfinity, kInfinity};
  std::array<float, 3> high = {-kInfinity, -kInfinity, -kInfinity};

  static constexpr float kInfinity = std::numeric_limits<float>::infinity();

  void include(const FloatBox& other) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], other.low[a]);
      high[a] = std::max(high[a], other.high[a]);
    }
  }
};

/// Four boxes that are tested at once.
struct FourBoxes {
  using Four = Vector<float, 4>;

  std::array<Four, 3> lows;
  std::array<Four, 3> highs;

  void set(std::size_t i, const FloatBox& box) {
    for (std::size_t a = 0; a < 3; ++a) {
      lows[a][i] = box.low[a];
      highs[a][i] = box.high[a];
    }
  }
  FloatBox box(std::size_t i) const {
    return {{lows[0][i], lows[1][i], lows[2][i]}, {highs[0][i], highs[1][i], highs[2][i]}};
  }
  // Bit i: box i overlaps the other box.
  unsigned overlap_mask(const FloatBox& other) const {
    const auto overlaps = (lows[0] <= other.high[0]) & (highs[0] >= other.low[0]) &
                          (lows[1] <= other.high[1]) & (highs[1] >= other.low[1]) &
                          (lows[2] <= other.high[2]) & (highs[2] >= other.low[2]);
#if defined(PREFILTER_SSE4_1)
    return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(overlaps)));
#else
    return (overlaps[0] != 0 ? 1U : 0U) | (overlaps[1] != 0 ? 2U : 0U) |
           (overlaps[2] != 0 ? 4U : 0U) | (overlaps[3] != 0 ? 8U : 0U);
#endif
  }
};

struct TriangleLeaf {
  static constexpr std::size_t kTriangles = 8;

  std::array<FourBoxes, kTriangles / 4> boxes;
  std::array<std::uint32_t, kTriangles> triangles;
  std::array<std::array<std::int32_t, 3>, kTriangles> vertices;
  unsigned suspects = 0;    // bit mask
  unsigned degenerate = 0;  // bit mask: corners are collinear
  unsigned count = 0;

  FloatBox box(std::size_t i) const { return boxes[i / 4].box(i % 4); }
  unsigned overlap_mask(const FloatBox& other) const {
    return boxes[0].overlap_mask(other) | boxes[1].overlap_mask(other) << 4U;
  }
};

/// Nodes of one level, each the parent of four nodes of the level below; the lowest nodes are
/// leaves.
struct TriangleLevel {
  std::vector<FourBoxes> boxes;  // of four siblings
  // per node: whether it contains triangles that are not suspect
  std::vector<std::uint8_t> has_others;
};

struct TriangleTree {
  static constexpr std::size_t kChildren = 4;

  std::vector<TriangleLeaf> leaves;
  std::vector<TriangleLevel> levels;  // leaves first

  FloatBox box(std::size_t leaf) const {
    return levels[0].boxes[leaf / kChildren].box(leaf % kChildren);
  }
};

/// Sorts triangles along the Morton curve, with much larger ones in separate leaves. `is_suspect`
/// is as in intersecting_triangles; `box` is the positions' bounding box. Throws Error(kCancelled).
TriangleTree build_tree(const MeshView<std::int32_t>& mesh,
                        std::span<const std::uint8_t> is_suspect, const Box& box, const Run& run);

/// Leaves and their boxes, four at a time.
struct NearLeaves {
  std::vector<std::size_t> leaves;
  std::vector<FourBoxes> boxes;

  void clear() {
    leaves.clear();
    boxes.clear();
  }
  void add(std::size_t leaf, const FloatBox& box) {
    const std::size_t place = leaves.size() % 4;
    if (place == 0) {
      boxes.emplace_back();
      for (std::size_t i = 0; i < 4; ++i) boxes.back().set(i, FloatBox());
    }
    boxes.back().set(place, box);
    leaves.push_back(leaf);
  }
};

/// Collects the leaves that overlap a given one, except earlier leaves that contain only suspects,
/// since these have found the pair already.
void find_near(const TriangleTree& tree, std::size_t leaf, NearLeaves* near);

}  // namespace prefilter
