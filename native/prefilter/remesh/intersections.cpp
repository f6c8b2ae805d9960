// SPDX-License-Identifier: GPL-3.0-or-later

// A tree of boxes over the triangles in the order of the Morton curve, those much larger than most
// by themselves; then pairs of triangles whose boxes meet.
#include "prefilter/remesh/intersections.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"
#include "prefilter/base/vectors.h"
#include "prefilter/remesh/predicates.h"
#include "prefilter/remesh/triangle_pair.h"
#include "prefilter/spatial/morton.h"

namespace prefilter {
namespace {

constexpr std::int64_t kRowsPerTask = 1 << 13;
constexpr std::int64_t kLeavesPerTask = 1 << 8;
constexpr std::size_t kLeafTriangles = 8;
constexpr std::size_t kChildren = 4;

using Mesh = MeshView<std::int32_t>;
using Pair = std::array<std::uint32_t, 2>;

// Positions rounded to floats keep their order, so that boxes which meet still do.
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
  bool meets(const FloatBox& other) const {
    unsigned meets = 1;  // Of bits: comparing goes on without a branch.
    for (std::size_t a = 0; a < 3; ++a) {
      meets &= static_cast<unsigned>(low[a] <= other.high[a]);
      meets &= static_cast<unsigned>(other.low[a] <= high[a]);
    }
    return meets != 0;
  }
};

// Four boxes that are compared with another one at once.
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

struct Leaf {
  std::array<FourBoxes, kLeafTriangles / 4> boxes;
  std::array<std::uint32_t, kLeafTriangles> triangles;
  std::array<std::array<std::int32_t, 3>, kLeafTriangles> vertices;
  unsigned suspects = 0;    // a bit each
  unsigned degenerate = 0;  // on one line
  unsigned count = 0;

  FloatBox box(std::size_t i) const { return boxes[i / 4].box(i % 4); }
  unsigned meeting(const FloatBox& other) const {
    return boxes[0].meeting(other) | boxes[1].meeting(other) << 4U;
  }
};

// Leaves and their boxes.
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

// Nodes of a tree, each above four of the level below; the lowest ones are leaves.
struct Level {
  std::vector<FourBoxes> boxes;          // of four nodes that are below the same one
  std::vector<std::uint8_t> has_others;  // of each node: triangles that are not suspect
};

// The box of the mesh in which positions become floats from 0 to 1.
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

// The sizes of coordinates, and the box of the positions that triangles have.
struct Extent {
  Box box = kEmptyBox;
  double smallest = std::numeric_limits<double>::infinity();  // but for 0
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

Extent extent_of(std::span<const Vector3> positions, const Progress& progress, int threads) {
  const auto rows = static_cast<std::int64_t>(positions.size());
  std::vector<Extent> extents(static_cast<std::size_t>(range_count(rows, kRowsPerTask)));
  parallel_ranges(rows, kRowsPerTask, threads, progress, [&](std::int64_t begin, std::int64_t end) {
    Extent& extent = extents[static_cast<std::size_t>(begin / kRowsPerTask)];
    for (std::int64_t i = begin; i < end; ++i)
      extent.include(positions[static_cast<std::size_t>(i)]);
  });
  Extent all;
  for (const Extent& extent : extents) all.include(extent);
  return all;
}

// Scaled by a power of two, and without what is too small beside the largest.
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

class Finder {
 public:
  Finder(const Mesh& mesh, std::span<const std::uint8_t> is_suspect, const Extent& extent,
         const Progress& progress, int threads)
      : mesh_(mesh), is_suspect_(is_suspect), threads_(threads) {
    double size = 0.0;
    for (int a = 0; a < 3; ++a) size = std::max(size, extent.box.size(a));
    frame_ = {extent.box.low, size > 0.0 ? 1.0 / size : 1.0};
    sort_items(progress.part(0.0, 0.8));
    make_nodes(progress.part(0.8, 1.0));
  }

  std::vector<Pair> find(const Progress& progress) const {
    const auto leaves = static_cast<std::int64_t>(leaves_.size());
    std::vector<std::vector<Pair>> found(
        static_cast<std::size_t>(range_count(leaves, kLeavesPerTask)));
    const auto find_some = [&](std::int64_t begin, std::int64_t end) {
      std::vector<Pair>& pairs = found[static_cast<std::size_t>(begin / kLeavesPerTask)];
      NearLeaves near;
      for (std::int64_t leaf = begin; leaf < end; ++leaf) {
        find_at(static_cast<std::size_t>(leaf), &near, &pairs);
      }
    };
    parallel_ranges(leaves, kLeavesPerTask, threads_, progress.part(0.0, 0.95), find_some);
    std::vector<Pair> all;
    for (const std::vector<Pair>& pairs : found) all.insert(all.end(), pairs.begin(), pairs.end());
    sort_in_parallel(&all, progress.part(0.95, 1.0), threads_);
    return all;
  }

 private:
  bool is_suspect(std::size_t triangle) const {
    return is_suspect_.empty() || is_suspect_[triangle] != 0;
  }

  static float size_of(const FloatBox& box) {
    return std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
  }

  void sort_items(const Progress& progress) {
    const auto rows = static_cast<std::int64_t>(mesh_.triangles.size());
    const auto tasks = static_cast<std::size_t>(range_count(rows, kRowsPerTask));
    std::vector<double> sums(tasks);
    const auto measure = [&](std::int64_t begin, std::int64_t end) {
      double sum = 0.0;
      for (std::int64_t t = begin; t < end; ++t) {
        sum += size_of(frame_.box_of(mesh_.corners(static_cast<std::size_t>(t))));
      }
      sums[static_cast<std::size_t>(begin / kRowsPerTask)] = sum;
    };
    parallel_ranges(rows, kRowsPerTask, threads_, progress.part(0.0, 0.1), measure);
    double mean = 0.0;
    for (const double sum : sums) mean += sum;
    mean /= static_cast<double>(rows);

    std::vector<std::uint64_t> keys(mesh_.triangles.size());
    const auto place = [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t t = begin; t < end; ++t) {
        const FloatBox box = frame_.box_of(mesh_.corners(static_cast<std::size_t>(t)));
        keys[static_cast<std::size_t>(t)] =
            key_of(box, static_cast<float>(mean)) << 32U | static_cast<std::uint64_t>(t);
      }
    };
    parallel_ranges(rows, kRowsPerTask, threads_, progress.part(0.1, 0.2), place);
    sort_in_parallel(&keys, progress.part(0.2, 0.8), threads_);

    leaves_.resize((keys.size() + kLeafTriangles - 1) / kLeafTriangles);
    const auto leaf_count = static_cast<std::int64_t>(leaves_.size());
    const auto fill = [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        const auto leaf = static_cast<std::size_t>(i);
        const std::size_t first = leaf * kLeafTriangles;
        const std::size_t count = std::min(kLeafTriangles, keys.size() - first);
        make_leaf(std::span(keys).subspan(first, count), &leaves_[leaf]);
      }
    };
    parallel_ranges(leaf_count, kRowsPerTask / 8, threads_, progress.part(0.8, 1.0), fill);
  }

  void make_leaf(std::span<const std::uint64_t> keys, Leaf* leaf) const {
    for (std::size_t i = 0; i < kLeafTriangles; ++i) {
      if (i >= keys.size()) {
        leaf->boxes[i / 4].set(i % 4, FloatBox());
        continue;
      }
      const auto triangle = static_cast<std::uint32_t>(keys[i]);
      const std::array<Vector3, 3> corners = mesh_.corners(triangle);
      leaf->boxes[i / 4].set(i % 4, frame_.box_of(corners));
      leaf->triangles[i] = triangle;
      leaf->vertices[i] = mesh_.triangles[triangle];
      if (is_suspect(triangle)) leaf->suspects |= 1U << i;
      if (are_on_one_line(corners[0], corners[1], corners[2])) leaf->degenerate |= 1U << i;
      ++leaf->count;
    }
  }

  // The larger ones apart, in four classes; then the Morton curve.
  static std::uint64_t key_of(const FloatBox& box, float mean) {
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

  void make_nodes(const Progress& progress) {
    std::vector<FloatBox> boxes(leaves_.size());
    std::vector<std::uint8_t> has_others(leaves_.size());
    const auto count = static_cast<std::int64_t>(leaves_.size());
    const auto make_some = [&](std::int64_t begin, std::int64_t end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
        const Leaf& leaf = leaves_[i];
        for (unsigned k = 0; k < leaf.count; ++k) boxes[i].include(leaf.box(k));
        has_others[i] = static_cast<unsigned>(std::popcount(leaf.suspects)) < leaf.count ? 1 : 0;
      }
    };
    parallel_ranges(count, kRowsPerTask, threads_, progress, make_some);
    while (true) {
      const std::size_t above = (boxes.size() + kChildren - 1) / kChildren;
      std::vector<FloatBox> boxes_above(above);
      std::vector<std::uint8_t> has_others_above(above);
      Level level;
      level.boxes.resize(above);
      for (std::size_t i = 0; i < above * kChildren; ++i) {
        const FloatBox box = i < boxes.size() ? boxes[i] : FloatBox();
        level.boxes[i / kChildren].set(i % kChildren, box);
        if (i >= boxes.size()) continue;
        boxes_above[i / kChildren].include(box);
        has_others_above[i / kChildren] |= has_others[i];
      }
      level.has_others = std::move(has_others);
      levels_.push_back(std::move(level));
      if (above == 1) break;
      boxes = std::move(boxes_above);
      has_others = std::move(has_others_above);
    }
  }

  // The leaves that meet this one, but for those before it without triangles that are not suspect:
  // they have found this one.
  void find_near(std::size_t leaf, NearLeaves* near) const {
    near->clear();
    const FloatBox box = levels_[0].boxes[leaf / kChildren].box(leaf % kChildren);
    struct Waiting {
      std::size_t level;
      std::size_t four;
    };
    // Four on each level: 2^32 triangles have at most 16 levels.
    std::array<Waiting, 64> waiting;
    std::size_t count = 0;
    waiting[count++] = {levels_.size() - 1, 0};
    while (count > 0) {
      const auto [at, four] = waiting[--count];
      const Level& level = levels_[at];
      const FourBoxes& boxes = level.boxes[four];
      for (unsigned met = boxes.meeting(box); met != 0; met &= met - 1U) {
        const auto k = static_cast<std::size_t>(std::countr_zero(met));
        const std::size_t node = four * kChildren + k;
        if (level.has_others[node] == 0 && ((node + 1) << (2 * at)) <= leaf) continue;
        if (at == 0) {
          near->add(node, boxes.box(k));
        } else {
          waiting[count++] = {at - 1, node};
        }
      }
    }
  }

  Corners corners_of(const Leaf& leaf, std::size_t i) const {
    const auto& [a, b, c] = leaf.vertices[i];
    return {
        {mesh_.positions[static_cast<std::size_t>(a)], mesh_.positions[static_cast<std::size_t>(b)],
         mesh_.positions[static_cast<std::size_t>(c)]},
        leaf.vertices[i]};
  }

  void find_at(std::size_t at, NearLeaves* near, std::vector<Pair>* pairs) const {
    const Leaf& leaf = leaves_[at];
    if (leaf.suspects == 0) return;
    find_near(at, near);
    for (unsigned i = 0; i < leaf.count; ++i) {
      const unsigned bit = 1U << i;
      if ((leaf.suspects & bit) == 0) continue;
      if ((leaf.degenerate & bit) != 0) {
        pairs->push_back({leaf.triangles[i], leaf.triangles[i]});
        continue;
      }
      const FloatBox box = leaf.box(i);
      const Corners corners = corners_of(leaf, i);
      for (std::size_t four = 0; four < near->boxes.size(); ++four) {
        for (unsigned met = near->boxes[four].meeting(box); met != 0; met &= met - 1U) {
          const auto k = static_cast<std::size_t>(std::countr_zero(met));
          find_pairs(at, i, box, corners, near->leaves[4 * four + k], pairs);
        }
      }
    }
  }

  // Those of a suspect with triangles of another leaf, or of its own.
  void find_pairs(std::size_t at, unsigned i, const FloatBox& box, const Corners& corners,
                  std::size_t other_at, std::vector<Pair>* pairs) const {
    const Leaf& leaf = leaves_[at];
    const Leaf& other = leaves_[other_at];
    unsigned met = other.meeting(box) & ~other.degenerate;
    // Two suspects are a pair of the first one.
    if (other_at < at) met &= ~other.suspects;
    if (other_at == at) met &= ~(other.suspects & ((2U << i) - 1U));
    for (; met != 0; met &= met - 1U) {
      const auto k = static_cast<std::size_t>(std::countr_zero(met));
      if (!do_intersect(corners, corners_of(other, k))) continue;
      const auto [low, high] = std::minmax(leaf.triangles[i], other.triangles[k]);
      pairs->push_back({low, high});
    }
  }

  Mesh mesh_;
  std::span<const std::uint8_t> is_suspect_;
  int threads_;
  Frame frame_;
  std::vector<Leaf> leaves_;
  std::vector<Level> levels_;  // that of leaves first
};
}  // namespace

std::vector<std::array<std::uint32_t, 2>> intersecting_triangles(
    const MeshView<std::int32_t>& mesh, std::span<const std::uint8_t> is_suspect,
    const Progress& progress, int threads) {
  if (mesh.triangles.empty()) return {};
  const Extent extent = extent_of(mesh.positions, progress.part(0.0, 0.05), threads);
  if (extent.largest > kLargestExact || extent.smallest < kSmallestExact) {
    const std::vector<Vector3> scaled = in_exact_range(mesh.positions, extent.largest);
    return intersecting_triangles({scaled, mesh.triangles}, is_suspect, progress.part(0.05, 1.0),
                                  threads);
  }
  const Finder finder(mesh, is_suspect, extent, progress.part(0.05, 0.3), threads);
  return finder.find(progress.part(0.3, 1.0));
}

}  // namespace prefilter
