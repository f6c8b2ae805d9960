// SPDX-License-Identifier: GPL-3.0-or-later

// A tree of boxes over triangles, four at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/vectors.h"

namespace prefilter {

/// Positions rounded to floats keep their order, so that boxes which meet still do.
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

/// Four boxes that are compared with another one at once.
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
  // A bit for each that meets the other one.
  unsigned meeting(const FloatBox& other) const {
    const auto meets = (lows[0] <= other.high[0]) & (highs[0] >= other.low[0]) &
                       (lows[1] <= other.high[1]) & (highs[1] >= other.low[1]) &
                       (lows[2] <= other.high[2]) & (highs[2] >= other.low[2]);
#if defined(PREFILTER_SSE4_1)
    return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(meets)));
#else
    return (meets[0] != 0 ? 1U : 0U) | (meets[1] != 0 ? 2U : 0U) | (meets[2] != 0 ? 4U : 0U) |
           (meets[3] != 0 ? 8U : 0U);
#endif
  }
};

struct TriangleLeaf {
  static constexpr std::size_t kTriangles = 8;

  std::array<FourBoxes, kTriangles / 4> boxes;
  std::array<std::uint32_t, kTriangles> triangles;
  std::array<std::array<std::int32_t, 3>, kTriangles> vertices;
  unsigned suspects = 0;    // a bit each
  unsigned degenerate = 0;  // on one line
  unsigned count = 0;

  FloatBox box(std::size_t i) const { return boxes[i / 4].box(i % 4); }
  unsigned meeting(const FloatBox& other) const {
    return boxes[0].meeting(other) | boxes[1].meeting(other) << 4U;
  }
};

/// Nodes of a tree, each above four of the level below; the lowest ones are leaves.
struct TriangleLevel {
  std::vector<FourBoxes> boxes;          // of four nodes that are below the same one
  std::vector<std::uint8_t> has_others;  // of each node: triangles that are not suspect
};

struct TriangleTree {
  static constexpr std::size_t kChildren = 4;

  std::vector<TriangleLeaf> leaves;
  std::vector<TriangleLevel> levels;  // that of leaves first

  FloatBox box(std::size_t leaf) const {
    return levels[0].boxes[leaf / kChildren].box(leaf % kChildren);
  }
};

/// Triangles in the order of the Morton curve, those much larger than most by themselves. Suspects
/// as intersecting_triangles has them; `box` is that of the positions. Throws Error(kCancelled).
TriangleTree build_tree(const MeshView<std::int32_t>& mesh,
                        std::span<const std::uint8_t> is_suspect, const Box& box,
                        const Progress& progress, int threads);

/// Leaves with their boxes, four at a time.
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

/// The leaves that meet this one, but for those before it without triangles that are not suspect:
/// they have found this one.
void find_near(const TriangleTree& tree, std::size_t leaf, NearLeaves* near);

}  // namespace prefilter
