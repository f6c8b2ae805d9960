// Closed surfaces inside of others.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// A closed part of a mesh.
struct ClosedPart {
  double volume = 0.0;
  double area = 0.0;
  std::size_t triangles = 0;
  std::size_t vertices = 0;
  std::size_t first_triangle = 0;
  bool is_mixed = false;  // its faces did not agree on which side is out: it is no cavity
  Box box = kEmptyBox;
};

/// The solid angle of a triangle seen from a point, over 4 pi: positive from behind it.
inline double winding_of(const std::array<Vector3, 3>& corners, const Vector3& point) {
  const Vector3 a = corners[0] - point;
  const Vector3 b = corners[1] - point;
  const Vector3 c = corners[2] - point;
  const double la = length(a);
  const double lb = length(b);
  const double lc = length(c);
  const double over = dot(a, cross(b, c));
  const double under = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return std::atan2(over, under) / (2.0 * std::numbers::pi);
}

/// Which parts are to be turned for each to be right side out or a cavity of others. `part_of(t)`
/// is the part of a triangle, or parts.size() where it has none.
///
/// Where the volumes sum up to less than 0 all are turned first, and mixed parts where their own is
/// negative. Parts of negative volume are then turned where the others do not wind around them.
template <typename Mesh, typename PartOf>
std::vector<bool> parts_to_turn(const Mesh& mesh, std::span<const ClosedPart> parts,
                                const PartOf& part_of, const Progress& progress, int threads) {
  constexpr std::int64_t kRowsPerTask = 1 << 14;
  double sum = 0.0;
  for (const ClosedPart& part : parts) sum += part.is_mixed ? 0.0 : part.volume;
  std::vector<bool> is_turned(parts.size());
  std::vector<double> ways(parts.size() + 1, 1.0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    is_turned[p] = parts[p].is_mixed ? parts[p].volume < 0.0 : sum < 0.0;
    ways[p] = is_turned[p] ? -1.0 : 1.0;
  }
  const auto rows = static_cast<std::int64_t>(mesh.triangles.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (ways[p] * parts[p].volume >= 0.0) continue;
    const std::array<Vector3, 3> corners = mesh.corners(parts[p].first_triangle);
    Vector3 point;
    for (std::size_t a = 0; a < 3; ++a) {
      point[a] = corners[0][a] / 3.0 + corners[1][a] / 3.0 + corners[2][a] / 3.0;
    }
    std::vector<bool> may_hold(parts.size() + 1, false);
    bool may_be_held = false;
    for (std::size_t q = 0; q < parts.size(); ++q) {
      may_hold[q] = q != p && parts[q].box.squared_distance(point) == 0.0;
      may_be_held = may_be_held || (may_hold[q] && ways[q] * parts[q].volume > 0.0);
    }
    double winding = 0.0;
    if (may_be_held) {
      std::vector<double> sums(static_cast<std::size_t>(range_count(rows, kRowsPerTask)), 0.0);
      parallel_ranges(rows, kRowsPerTask, threads,
                      progress.part(static_cast<double>(p) / static_cast<double>(parts.size()),
                                    static_cast<double>(p + 1) / static_cast<double>(parts.size())),
                      [&](std::int64_t begin, std::int64_t end) {
                        double& own = sums[static_cast<std::size_t>(begin / kRowsPerTask)];
                        for (auto t = static_cast<std::size_t>(begin);
                             t < static_cast<std::size_t>(end); ++t) {
                          const std::size_t part = part_of(t);
                          if (may_hold[part])
                            own += ways[part] * winding_of(mesh.corners(t), point);
                        }
                      });
      for (const double own : sums) winding += own;
    }
    if (winding < 0.5) is_turned[p] = !is_turned[p];
  }
  progress.report(1.0);
  return is_turned;
}

}  // namespace prefilter
