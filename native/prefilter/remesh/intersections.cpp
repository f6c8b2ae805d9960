// A tree of boxes over the triangles in the order of the Morton curve, those much larger than most
// by themselves; then pairs of triangles whose boxes meet.
#include "prefilter/remesh/intersections.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"
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
    return (low[0] <= other.high[0]) & (other.low[0] <= high[0]) & (low[1] <= other.high[1]) &
           (other.low[1] <= high[1]) & (low[2] <= other.high[2]) & (other.low[2] <= high[2]);
  }
};

struct Item {
  FloatBox box;
  std::uint32_t triangle;
  bool is_suspect;
  bool is_degenerate;
};

struct Node {
  FloatBox box;
  bool has_suspects = false;
  bool has_others = false;

  void include(const Node& other) {
    box.include(other.box);
    has_suspects = has_suspects || other.has_suspects;
    has_others = has_others || other.has_others;
  }
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
    const auto leaves = static_cast<std::int64_t>(levels_[0].size());
    std::vector<std::vector<Pair>> found(
        static_cast<std::size_t>(range_count(leaves, kLeavesPerTask)));
    const auto find_some = [&](std::int64_t begin, std::int64_t end) {
      std::vector<Pair>& pairs = found[static_cast<std::size_t>(begin / kLeavesPerTask)];
      std::vector<std::size_t> near;
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

    items_.resize(keys.size());
    const auto fill = [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        const auto place_of = static_cast<std::size_t>(i);
        const auto triangle = static_cast<std::uint32_t>(keys[place_of]);
        const std::array<Vector3, 3> corners = mesh_.corners(triangle);
        items_[place_of] = {frame_.box_of(corners), triangle, is_suspect(triangle),
                            are_on_one_line(corners[0], corners[1], corners[2])};
      }
    };
    parallel_ranges(rows, kRowsPerTask, threads_, progress.part(0.8, 1.0), fill);
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
    levels_.emplace_back((items_.size() + kLeafTriangles - 1) / kLeafTriangles);
    const auto leaves = static_cast<std::int64_t>(levels_[0].size());
    const auto make_leaves = [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        const auto leaf = static_cast<std::size_t>(i);
        Node& node = levels_[0][leaf];
        for (const Item& item : items_of(leaf)) {
          node.include({item.box, item.is_suspect, !item.is_suspect});
        }
      }
    };
    parallel_ranges(leaves, kRowsPerTask, threads_, progress, make_leaves);
    while (levels_.back().size() > 1) {
      const std::vector<Node>& below = levels_.back();
      std::vector<Node> level((below.size() + kChildren - 1) / kChildren);
      for (std::size_t i = 0; i < below.size(); ++i) level[i / kChildren].include(below[i]);
      levels_.push_back(std::move(level));
    }
  }

  std::span<const Item> items_of(std::size_t leaf) const {
    const std::size_t begin = leaf * kLeafTriangles;
    return std::span(items_).subspan(begin, std::min(kLeafTriangles, items_.size() - begin));
  }

  // The leaves that meet this one, but for those before it without triangles that are not suspect:
  // they have found this one.
  void find_near(std::size_t leaf, std::vector<std::size_t>* near) const {
    near->clear();
    const FloatBox& box = levels_[0][leaf].box;
    struct Waiting {
      std::size_t level;
      std::size_t node;
    };
    // Four on each level: 2^32 triangles have at most 16 levels.
    std::array<Waiting, 64> waiting;
    std::size_t count = 0;
    waiting[count++] = {levels_.size() - 1, 0};
    while (count > 0) {
      const auto [level, node] = waiting[--count];
      const Node& found = levels_[level][node];
      if (!found.box.meets(box)) continue;
      if (!found.has_others && ((node + 1) << (2 * level)) <= leaf) continue;
      if (level == 0) {
        near->push_back(node);
        continue;
      }
      const std::size_t first = node * kChildren;
      const std::size_t last = std::min(first + kChildren, levels_[level - 1].size());
      for (std::size_t child = first; child < last; ++child) waiting[count++] = {level - 1, child};
    }
  }

  Corners corners_of(const Item& item) const {
    return {mesh_.corners(item.triangle), mesh_.triangles[item.triangle]};
  }

  void find_at(std::size_t leaf, std::vector<std::size_t>* near, std::vector<Pair>* pairs) const {
    if (!levels_[0][leaf].has_suspects) return;
    find_near(leaf, near);
    for (const Item& item : items_of(leaf)) {
      if (!item.is_suspect) continue;
      if (item.is_degenerate) {
        pairs->push_back({item.triangle, item.triangle});
        continue;
      }
      const Corners corners = corners_of(item);
      for (const std::size_t other_leaf : *near) {
        if (!levels_[0][other_leaf].box.meets(item.box)) continue;
        for (const Item& other : items_of(other_leaf)) {
          if (!other.box.meets(item.box) || other.is_degenerate) continue;
          if (other.is_suspect && &other <= &item) continue;
          if (!do_intersect(corners, corners_of(other))) continue;
          const auto [low, high] = std::minmax(item.triangle, other.triangle);
          pairs->push_back({low, high});
        }
      }
    }
  }

  Mesh mesh_;
  std::span<const std::uint8_t> is_suspect_;
  int threads_;
  Frame frame_;
  std::vector<Item> items_;
  std::vector<std::vector<Node>> levels_;  // the leaves first
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
