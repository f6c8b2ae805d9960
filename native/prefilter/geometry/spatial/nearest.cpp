// SPDX-License-Identifier: GPL-3.0-or-later

// A bounding box tree over the triangles, in Morton order of their centers.
//
// Identical triangles are merged, with the lowest of their indices: since the boxes may be closer
// than the triangles, no box would exclude any of them, and each search would test them all.
#include "prefilter/geometry/nearest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"
#include "prefilter/geometry/spatial/box_tree.h"
#include "prefilter/geometry/spatial/curve_order.h"
#include "prefilter/geometry/spatial/triangle_point.h"

namespace prefilter {
namespace {

constexpr std::size_t kLeafTriangles = 4;
// Small, so that tasks end soon even if searches test very many triangles.
constexpr std::int64_t kPointsPerTask = 64;
constexpr std::int64_t kRowsPerTask = 1 << 15;
constexpr double kLargestNear = 1e150;

// The corners of a triangle, sorted to be independent of the starting corner.
std::array<Vector3, 3> sorted_corners(const InputMesh& mesh, std::size_t triangle) {
  std::array<Vector3, 3> corners = mesh.corners(triangle);
  std::sort(corners.begin(), corners.end());
  return corners;
}

// A triangle to be compared with others at the same center.
struct Copy {
  std::array<Vector3, 3> corners;
  std::int32_t label;
  std::uint32_t index;

  bool is_of(const Copy& other) const { return corners == other.corners && label == other.label; }
  bool operator<(const Copy& other) const {
    if (corners != other.corners) return corners < other.corners;
    return label != other.label ? label < other.label : index < other.index;
  }
};

// Removes all but the first of identical triangles with the same label, whose keys are equal. Sets
// the position of each triangle on the curve, or that of the remaining copy.
void drop_copies(const InputMesh& mesh, std::span<const std::int32_t> labels, const Run& run,
                 std::vector<CurvePlace>* places, std::span<std::uint32_t> place_of) {
  constexpr std::size_t kCopiesPerSort = 1U << 15;
  std::vector<Copy> copies;
  std::size_t distinct = 0;
  for (std::size_t begin = 0, end = 0; begin < places->size(); begin = end) {
    const std::uint64_t key = (*places)[begin].key;
    while (end < places->size() && (*places)[end].key == key) ++end;
    const auto keep = [&](std::uint32_t index) {
      if (!place_of.empty()) place_of[index] = static_cast<std::uint32_t>(distinct);
      (*places)[distinct++] = {key, index};
    };
    if (end == begin + 1) {
      keep((*places)[begin].index);
      continue;
    }
    copies.clear();
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t index = (*places)[i].index;
      copies.push_back({sorted_corners(mesh, index), labels.empty() ? 0 : labels[index], index});
    }
    if (copies.size() < kCopiesPerSort) {
      std::sort(copies.begin(), copies.end());
    } else {
      sort_in_parallel(&copies, run);
    }
    for (std::size_t i = 0; i < copies.size(); ++i) {
      if (i == 0 || !copies[i].is_of(copies[i - 1])) {
        keep(copies[i].index);
      } else if (!place_of.empty()) {
        place_of[copies[i].index] = static_cast<std::uint32_t>(distinct - 1);
      }
    }
  }
  places->resize(distinct);
}

struct Best {
  double squared = std::numeric_limits<double>::infinity();
  std::size_t place = 0;
  std::uint32_t index = 0;
  Vector3 weights{};

  /// Whether a triangle at least this far away, with at least this index, may be better.
  bool may_be(double at_least, std::uint32_t lowest) const {
    return at_least < squared || (at_least == squared && lowest < index);
  }
};

}  // namespace

/// The tree, and a copy of the mesh.
class NearestPoints::Tree {
 public:
  Tree(const InputMesh& mesh, std::span<const std::int32_t> labels, const Run& run);

  std::vector<SurfacePoint> find(std::span<const Vector3> points, const Run& run) const;
  std::vector<SurfacePoint> find_on(std::span<const Vector3> points,
                                    std::span<const std::int32_t> origins, const Run& run) const;

 private:
  // Returns the Morton keys of the triangles.
  std::vector<std::uint64_t> sort_triangles(const InputMesh& mesh,
                                            std::span<const std::int32_t> labels, const Run& run);
  Box box_of(std::size_t place) const;
  void try_triangle(std::size_t place, const Vector3& point, Best* best) const;
  void search(const Vector3& point, std::optional<std::int32_t> label, Best* best) const;

  std::vector<Vector3> positions_;
  // Distinct triangles in Morton order of their centers, and their indices in the mesh.
  std::vector<std::array<std::int32_t, 3>> triangles_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::int32_t> labels_;  // per triangle in Morton order; empty without labels
  std::vector<std::uint32_t>
      places_;  // position of each of the mesh's triangles, or of its remaining copy
  BoxTree boxes_;
  std::vector<std::uint32_t> lowest_indices_;  // for each node of the tree
};

NearestPoints::Tree::Tree(const InputMesh& mesh, std::span<const std::int32_t> labels,
                          const Run& run) {
  check_mesh(mesh, kLargestNear);
  if (!labels.empty() && labels.size() != mesh.triangles.size()) {
    throw_invalid("labels: found " + std::to_string(labels.size()) + " for " +
                  std::to_string(mesh.triangles.size()) + " triangles; one each is needed");
  }
  const Stages stages(run, {4, 1});
  const std::vector<std::uint64_t> keys = sort_triangles(mesh, labels, stages[0]);
  const auto box = [&](std::size_t place) { return box_of(place); };
  boxes_ = BoxTree(keys, kLeafTriangles, box, stages[1]);
  lowest_indices_.resize(boxes_.nodes().size());
  for (std::size_t n = lowest_indices_.size(); n-- > 0;) {
    const BoxTree::Node& node = boxes_.nodes()[n];
    lowest_indices_[n] =
        node.right == 0
            ? *std::min_element(indices_.begin() + node.begin, indices_.begin() + node.end)
            : std::min(lowest_indices_[n + 1], lowest_indices_[node.right]);
  }
}

std::vector<std::uint64_t> NearestPoints::Tree::sort_triangles(const InputMesh& mesh,
                                                               std::span<const std::int32_t> labels,
                                                               const Run& run) {
  positions_.reserve(mesh.positions.size());
  for (const Vector3& position : mesh.positions) positions_.push_back(position);
  const auto middle = [&](std::size_t triangle) {
    Box box = kEmptyBox;
    for (const Vector3& corner : mesh.corners(triangle)) box.include(corner);
    Vector3 result;
    for (int a = 0; a < 3; ++a) result[a] = box.low[a] + box.size(a) / 2.0;
    return result;
  };
  const Stages stages(run, {8, 1, 1});
  std::vector<CurvePlace> places = along_curve(mesh.triangles.size(), middle, stages[0]);
  places_.resize(labels.size());
  drop_copies(mesh, labels, stages[1], &places, places_);
  labels_.resize(labels.empty() ? 0 : places.size());
  triangles_.resize(places.size());
  indices_.resize(places.size());
  std::vector<std::uint64_t> keys(places.size());
  const auto copy = [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      keys[i] = places[i].key;
      indices_[i] = places[i].index;
      if (!labels.empty()) labels_[i] = labels[places[i].index];
      const auto triangle = mesh.triangles[places[i].index];
      for (int c = 0; c < 3; ++c) triangles_[i][c] = static_cast<std::int32_t>(triangle[c]);
    }
  };
  parallel_ranges(static_cast<std::int64_t>(places.size()), kRowsPerTask, stages[2], copy);
  return keys;
}

Box NearestPoints::Tree::box_of(std::size_t place) const {
  Box box = kEmptyBox;
  for (const std::int32_t vertex : triangles_[place]) {
    box.include(positions_[static_cast<std::size_t>(vertex)]);
  }
  return box;
}

void NearestPoints::Tree::try_triangle(std::size_t place, const Vector3& point, Best* best) const {
  const auto& [i, j, k] = triangles_[place];
  const Vector3& a = positions_[static_cast<std::size_t>(i)];
  const Vector3& b = positions_[static_cast<std::size_t>(j)];
  const Vector3& c = positions_[static_cast<std::size_t>(k)];
  const Vector3 weights = nearest_weights(point, a, b, c);
  Vector3 offset;
  for (int x = 0; x < 3; ++x) {
    // Clamped to the triangle's box: otherwise a search could exclude the box because of rounding,
    // depending on its starting point.
    const double at = weights[0] * a[x] + weights[1] * b[x] + weights[2] * c[x];
    const double low = std::min({a[x], b[x], c[x]});
    const double high = std::max({a[x], b[x], c[x]});
    offset[x] = std::clamp(at, low, high) - point[x];
  }
  const double squared = dot(offset, offset);
  if (best->may_be(squared, indices_[place])) *best = {squared, place, indices_[place], weights};
}

void NearestPoints::Tree::search(const Vector3& point, std::optional<std::int32_t> label,
                                 Best* best) const {
  boxes_.search(
      point,
      [&](double squared, std::size_t node) {
        return best->may_be(squared, lowest_indices_[node]);
      },
      [&](std::size_t node) {
        for (std::size_t i = boxes_.nodes()[node].begin; i < boxes_.nodes()[node].end; ++i) {
          if (!label || labels_[i] == *label) try_triangle(i, point, best);
        }
      });
}

std::vector<SurfacePoint> NearestPoints::Tree::find(std::span<const Vector3> points,
                                                    const Run& run) const {
  check_points(points, "points: row", kLargestNear);
  const Stages stages(run, {1, 9});
  // Along the curve, neighboring points follow each other: the nearest triangle of the previous
  // point is a good initial guess, and its surroundings are in the cache.
  const std::vector<CurvePlace> order = along_curve(
      points.size(), [&](std::size_t i) { return points[i]; }, stages[0]);
  std::vector<SurfacePoint> found(points.size());
  const auto find_some = [&](std::int64_t begin, std::int64_t end) {
    std::size_t guess = 0;
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const Vector3& point = points[order[i].index];
      Best best;
      try_triangle(guess, point, &best);
      search(point, std::nullopt, &best);
      guess = best.place;
      found[order[i].index] = {best.index, best.weights, std::sqrt(best.squared)};
    }
  };
  parallel_ranges(static_cast<std::int64_t>(points.size()), kPointsPerTask, stages[1], find_some);
  return found;
}

std::vector<SurfacePoint> NearestPoints::Tree::find_on(std::span<const Vector3> points,
                                                       std::span<const std::int32_t> origins,
                                                       const Run& run) const {
  check_points(points, "points: row", kLargestNear);
  if (origins.size() != points.size()) {
    throw_invalid("origins: found " + std::to_string(origins.size()) + " for " +
                  std::to_string(points.size()) + " points; one each is needed");
  }
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (origins[i] >= 0 && static_cast<std::size_t>(origins[i]) < places_.size()) continue;
    throw_invalid("origins: item " + std::to_string(i) + " names triangle " +
                  std::to_string(origins[i]) + ", but " + std::to_string(places_.size()) +
                  " have labels");
  }
  std::vector<SurfacePoint> found(points.size());
  const auto find_some = [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const std::size_t origin = places_[static_cast<std::size_t>(origins[i])];
      Best best;
      try_triangle(origin, points[i], &best);
      search(points[i], labels_[origin], &best);
      found[i] = {best.index, best.weights, std::sqrt(best.squared)};
    }
  };
  parallel_ranges(static_cast<std::int64_t>(points.size()), kPointsPerTask, run, find_some);
  return found;
}

NearestPoints::NearestPoints(const InputMesh& mesh, const Run& run)
    : NearestPoints(mesh, {}, run) {}

NearestPoints::NearestPoints(const InputMesh& mesh, std::span<const std::int32_t> labels,
                             const Run& run)
    : tree_(std::make_unique<const Tree>(mesh, labels, run)) {}

NearestPoints::~NearestPoints() = default;

std::vector<SurfacePoint> NearestPoints::find(std::span<const Vector3> points,
                                              const Run& run) const {
  return tree_->find(points, run);
}

std::vector<SurfacePoint> NearestPoints::find_on(std::span<const Vector3> points,
                                                 std::span<const std::int32_t> origins,
                                                 const Run& run) const {
  return tree_->find_on(points, origins, run);
}

std::vector<SurfacePoint> nearest_points(std::span<const Vector3> points, const InputMesh& mesh,
                                         const Run& run) {
  const Stages stages(run, {3, 7});
  const NearestPoints tree(mesh, stages[0]);
  return tree.find(points, stages[1]);
}

}  // namespace prefilter
