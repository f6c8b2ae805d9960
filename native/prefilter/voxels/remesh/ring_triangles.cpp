// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/ring_triangles.h"

#include <algorithm>

namespace prefilter {
namespace {

constexpr double kForbidden = 1e30;  // cost
constexpr double kFaultCost = 1e3;   // above the cost of any sides, so that faults count first

// Best triangulation of a range of points.
struct BestSpan {
  double cost;
  double fault;
  std::size_t apex;
};
using Table = std::array<std::array<BestSpan, kMaxRingSize>, kMaxRingSize>;
using Squares = std::array<std::array<double, kMaxRingSize>, kMaxRingSize>;

// Product of the squares of a triangle's two longest sides.
double sides_of(const Squares& squares, std::size_t i, std::size_t j, std::size_t k) {
  const double u = squares[i][j];
  const double v = squares[j][k];
  const double w = squares[i][k];
  return std::max({u, v, w}) * std::max(std::min(u, v), std::min(std::max(u, v), w));
}

// Lists the triangles depth first.
void list_triangles(const Table& best, std::size_t last, RingTriangles* result) {
  std::array<std::array<std::size_t, 2>, kMaxRingSize> waiting;
  std::size_t waiting_count = 0;
  waiting[waiting_count++] = {0, last};
  result->count = 0;
  while (waiting_count > 0) {
    const auto [i, j] = waiting[--waiting_count];
    if (j - i < 2) continue;
    const std::size_t k = best[i][j].apex;
    result->triangles[result->count++] = {i, k, j};
    waiting[waiting_count++] = {i, k};
    waiting[waiting_count++] = {k, j};
  }
}
}  // namespace

bool triangulate_ring(std::span<const Vector3> points, const Vector3& direction, double unit,
                      double least, RingTriangles* result) {
  const std::size_t count = points.size();
  Squares squares;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      const Vector3 side = points[j] - points[i];
      squares[i][j] = dot(side, side);
    }
  }
  Table best;
  for (std::size_t i = 0; i + 1 < count; ++i) best[i][i + 1] = {0.0, 0.0, 0};
  for (std::size_t span = 2; span < count; ++span) {
    for (std::size_t i = 0; i + span < count; ++i) {
      const std::size_t j = i + span;
      BestSpan top = {kForbidden, 0.0, i + 1};
      for (std::size_t k = i + 1; k < j; ++k) {
        const double below = best[i][k].cost + best[k][j].cost;
        if (!(below < top.cost)) continue;
        const Vector3 normal = cross(points[k] - points[i], points[j] - points[i]);
        const double along = dot(normal, direction);
        const double area = dot(normal, normal);
        if (!(along > 0.0) || !(along * along > least * least * area)) continue;
        const double sides = sides_of(squares, i, k, j);
        const double fault = area < kMinWidth * sides ? fault_of(area / sides) : 0.0;
        const double squares_sum = squares[i][k] + squares[k][j] + squares[i][j];
        const double cost = below + (unit * along) * (unit * squares_sum) + kFaultCost * fault;
        if (cost < top.cost) top = {cost, best[i][k].fault + best[k][j].fault + fault, k};
      }
      best[i][j] = top;
    }
  }
  const BestSpan& whole = best[0][count - 1];
  if (!(whole.cost < kForbidden)) return false;
  result->fault = whole.fault;
  list_triangles(best, count - 1, result);
  return true;
}

}  // namespace prefilter
