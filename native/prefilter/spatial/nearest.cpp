// A binary tree of boxes over the triangles in the order of the Morton curve through their centres.
// Node i has the children 2 i + 1 and 2 i + 2, and shares its range of triangles out in halves, so
// that the tree is an array of boxes. Closest points of triangles: Ericson, Real-Time Collision
// Detection (2005), section 5.1.5.
#include "prefilter/spatial/nearest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"

namespace prefilter {
namespace {

using Vector = std::array<double, 3>;

constexpr std::size_t kLeafTriangles = 4;
constexpr std::size_t kPointsPerTask = 1U << 12;
constexpr double kLargest = 1e150;

Vector operator-(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Where a point's foot on the segment from the origin along `edge` is, in [0, 1]; `along` is the
// point's product with the edge.
double on_segment(double along, double squared_length) {
  return squared_length > 0.0 ? std::clamp(along / squared_length, 0.0, 1.0) : 0.0;
}

// The weights of the triangle's corners at its point nearest to p.
Vector nearest_weights(const Vector& p, const Vector& a, const Vector& b, const Vector& c) {
  const Vector ab = b - a;
  const Vector ac = c - a;
  const Vector ap = p - a;
  const double d1 = dot(ab, ap);
  const double d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1.0, 0.0, 0.0};
  const Vector bp = p - b;
  const double d3 = dot(ab, bp);
  const double d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return {0.0, 1.0, 0.0};
  const Vector cp = p - c;
  const double d5 = dot(ab, cp);
  const double d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 0.0, 1.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double t = on_segment(d1, d1 - d3);
    return {1.0 - t, t, 0.0};
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double t = on_segment(d2, d2 - d6);
    return {1.0 - t, 0.0, t};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double t = on_segment(d4 - d3, (d4 - d3) + (d5 - d6));
    return {0.0, 1.0 - t, t};
  }
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) return {1.0, 0.0, 0.0};
  const double v = vb / sum;
  const double w = vc / sum;
  return {std::max(0.0, 1.0 - v - w), v, w};
}

struct Bounds {
  Vector low;
  Vector high;

  double squared_distance(const Vector& p) const {
    double sum = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double outside = std::max({low[a] - p[a], p[a] - high[a], 0.0});
      sum += outside * outside;
    }
    return sum;
  }
};

constexpr Bounds kEmpty = {
    {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
     std::numeric_limits<double>::infinity()},
    {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
     -std::numeric_limits<double>::infinity()}};

void include(const Bounds& other, Bounds* bounds) {
  for (int a = 0; a < 3; ++a) {
    bounds->low[a] = std::min(bounds->low[a], other.low[a]);
    bounds->high[a] = std::max(bounds->high[a], other.high[a]);
  }
}

// 21 bits an axis, with two zeros between them.
std::uint64_t spread_bits(std::uint64_t n) {
  n = (n | (n << 32U)) & 0x1F00000000FFFFULL;
  n = (n | (n << 16U)) & 0x1F0000FF0000FFULL;
  n = (n | (n << 8U)) & 0x100F00F00F00F00FULL;
  n = (n | (n << 4U)) & 0x10C30C30C30C30C3ULL;
  n = (n | (n << 2U)) & 0x1249249249249249ULL;
  return n;
}

// The indices of points along the Morton curve through their box.
std::vector<std::size_t> morton_order(std::span<const Vector> points) {
  Bounds all = kEmpty;
  for (const Vector& point : points) include({point, point}, &all);
  std::vector<std::pair<std::uint64_t, std::size_t>> keys(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::uint64_t key = 0;
    for (int a = 0; a < 3; ++a) {
      const double size = all.high[a] - all.low[a];
      const double place = size > 0.0 ? (points[i][a] - all.low[a]) / size : 0.0;
      key |= spread_bits(static_cast<std::uint64_t>(place * 0x1FFFFF)) << a;
    }
    keys[i] = {key, i};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < keys.size(); ++i) order[i] = keys[i].second;
  return order;
}

class TriangleTree {
 public:
  TriangleTree(std::span<const Vector> positions,
               std::span<const std::array<std::int64_t, 3>> triangles)
      : positions_(positions), triangles_(triangles) {
    sort_triangles();
    while ((order_.size() >> depth_) > kLeafTriangles) ++depth_;
    nodes_.assign((std::size_t{2} << depth_) - 1, kEmpty);
    build(0, 0, order_.size(), 0);
  }

  SurfacePoint nearest(const Vector& point, const SurfacePoint& guess) const {
    SurfacePoint best;
    double best_squared = std::numeric_limits<double>::infinity();
    try_triangle(static_cast<std::size_t>(guess.triangle), point, &best, &best_squared);
    visit(0, 0, order_.size(), 0, nodes_[0].squared_distance(point), point, &best, &best_squared);
    best.distance = std::sqrt(best_squared);
    return best;
  }

 private:
  Bounds bounds_of(std::size_t triangle) const {
    Bounds bounds = kEmpty;
    for (const std::int64_t vertex : triangles_[triangle]) {
      const Vector& p = positions_[static_cast<std::size_t>(vertex)];
      include({p, p}, &bounds);
    }
    return bounds;
  }

  void sort_triangles() {
    std::vector<Vector> centres(triangles_.size());
    for (std::size_t t = 0; t < centres.size(); ++t) {
      const Bounds bounds = bounds_of(t);
      for (int a = 0; a < 3; ++a) {
        centres[t][a] = bounds.low[a] + (bounds.high[a] - bounds.low[a]) / 2.0;
      }
    }
    order_ = morton_order(centres);
  }

  void build(std::size_t node, std::size_t begin, std::size_t end, int level) {
    if (level == depth_) {
      for (std::size_t i = begin; i < end; ++i) include(bounds_of(order_[i]), &nodes_[node]);
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    build(2 * node + 1, begin, middle, level + 1);
    build(2 * node + 2, middle, end, level + 1);
    nodes_[node] = nodes_[2 * node + 1];
    include(nodes_[2 * node + 2], &nodes_[node]);
  }

  void try_triangle(std::size_t triangle, const Vector& point, SurfacePoint* best,
                    double* best_squared) const {
    const auto& [i, j, k] = triangles_[triangle];
    const Vector& a = positions_[static_cast<std::size_t>(i)];
    const Vector& b = positions_[static_cast<std::size_t>(j)];
    const Vector& c = positions_[static_cast<std::size_t>(k)];
    const Vector weights = nearest_weights(point, a, b, c);
    Vector offset;
    for (int x = 0; x < 3; ++x) {
      offset[x] = weights[0] * a[x] + weights[1] * b[x] + weights[2] * c[x] - point[x];
    }
    const double squared = dot(offset, offset);
    const auto index = static_cast<std::int64_t>(triangle);
    if (squared < *best_squared || (squared == *best_squared && index < best->triangle)) {
      *best_squared = squared;
      *best = {index, weights, 0.0};
    }
  }

  // Triangles at the same distance are all looked at, so that the guess does not matter.
  void visit(std::size_t node, std::size_t begin, std::size_t end, int level, double squared,
             const Vector& point, SurfacePoint* best, double* best_squared) const {
    if (squared > *best_squared) return;
    if (level == depth_) {
      for (std::size_t i = begin; i < end; ++i) {
        try_triangle(order_[i], point, best, best_squared);
      }
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    const double low = nodes_[2 * node + 1].squared_distance(point);
    const double high = nodes_[2 * node + 2].squared_distance(point);
    if (low <= high) {
      visit(2 * node + 1, begin, middle, level + 1, low, point, best, best_squared);
      visit(2 * node + 2, middle, end, level + 1, high, point, best, best_squared);
    } else {
      visit(2 * node + 2, middle, end, level + 1, high, point, best, best_squared);
      visit(2 * node + 1, begin, middle, level + 1, low, point, best, best_squared);
    }
  }

  std::span<const Vector> positions_;
  std::span<const std::array<std::int64_t, 3>> triangles_;
  std::vector<std::size_t> order_;
  int depth_ = 0;
  std::vector<Bounds> nodes_;
};

void check_values(std::span<const Vector> rows, const char* argument) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const double x : rows[i]) {
      if (std::abs(x) <= kLargest) continue;
      throw_invalid(std::string(argument) + ": row " + std::to_string(i) + " holds " + to_text(x) +
                    "; all values must be finite, and at most 1e150");
    }
  }
}
}  // namespace

std::vector<SurfacePoint> nearest_points(std::span<const Vector> points,
                                         std::span<const Vector> positions,
                                         std::span<const std::array<std::int64_t, 3>> triangles,
                                         const Progress& progress, int threads) {
  if (triangles.empty()) throw_invalid("triangles: none; at least one is needed");
  check_values(positions, "positions");
  check_values(points, "points");
  const auto count = static_cast<std::int64_t>(positions.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const std::int64_t vertex : triangles[t]) {
      if (vertex >= 0 && vertex < count) continue;
      throw_invalid("triangles: triangle " + std::to_string(t) + " names vertex " +
                    std::to_string(vertex) + "; there are " + std::to_string(count) +
                    ", from 0 on");
    }
  }
  const TriangleTree tree(positions, triangles);
  // Along the curve a point's neighbours come before it: theirs is a good first guess, and what was
  // read for them is at hand.
  const std::vector<std::size_t> order = morton_order(points);
  std::vector<SurfacePoint> found(points.size());
  const std::size_t tasks = (points.size() + kPointsPerTask - 1) / kPointsPerTask;
  parallel_for(static_cast<std::int64_t>(tasks), threads, progress, [&](std::int64_t task) {
    const std::size_t begin = static_cast<std::size_t>(task) * kPointsPerTask;
    const std::size_t end = std::min(points.size(), begin + kPointsPerTask);
    SurfacePoint guess;
    for (std::size_t i = begin; i < end; ++i) {
      guess = tree.nearest(points[order[i]], guess);
      found[order[i]] = guess;
    }
  });
  return found;
}

}  // namespace prefilter
