// SPDX-License-Identifier: GPL-3.0-or-later

// Closed surfaces inside of others.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "prefilter/base/elementary.h"
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
  return elementary::atan2(over, under) / (2.0 * std::numbers::pi);
}

/// Which parts are to be turned for each to be right side out or a cavity of others. `part_of(t)`
/// is the part of a triangle, or parts.size() where it has none.
///
/// Where the volumes sum up to less than 0 all are turned first. Parts of negative volume are then
/// turned where the others do not wind around them. Mixed parts are cavities where they lie in an
/// odd number of others.
template <typename Mesh, typename PartOf>
std::vector<bool> parts_to_turn(const Mesh& mesh, std::span<const ClosedPart> parts,
                                const PartOf& part_of, const Progress& progress, int threads) {
  constexpr std::int64_t kRowsPerTask = 1 << 14;
  constexpr std::size_t kPoints = 24;
  double sum = 0.0;
  for (const ClosedPart& part : parts) sum += part.is_mixed ? 0.0 : part.volume;
  // What a part's winding numbers count: as they will be, and as if all were right side out.
  std::vector<double> ways(parts.size() + 1, 1.0);
  std::vector<double> outward(parts.size() + 1, 1.0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    outward[p] = parts[p].volume < 0.0 ? -1.0 : 1.0;
    ways[p] = parts[p].is_mixed ? outward[p] : (sum < 0.0 ? -1.0 : 1.0);
  }
  const auto rows = static_cast<std::int64_t>(mesh.triangles.size());
  // The sum of some parts' winding numbers, each times its factor.
  const auto winding = [&](const Vector3& point, const std::vector<bool>& counts,
                           const std::vector<double>& factors, const Progress& part) {
    std::vector<double> sums(static_cast<std::size_t>(range_count(rows, kRowsPerTask)), 0.0);
    parallel_ranges(rows, kRowsPerTask, threads, part, [&](std::int64_t begin, std::int64_t end) {
      double& own = sums[static_cast<std::size_t>(begin / kRowsPerTask)];
      for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
        const std::size_t of = part_of(t);
        if (counts[of]) own += factors[of] * winding_of(mesh.corners(t), point);
      }
    });
    double all = 0.0;
    for (const double own : sums) all += own;
    return all;
  };
  // Middles of some triangles of a part.
  const auto points_of = [&](std::size_t p, std::size_t count) {
    // Odd, as meshes that were subdivided come in powers of two.
    const std::size_t step = parts[p].triangles / count | 1U;
    std::vector<Vector3> points;
    std::size_t place = 0;
    for (std::size_t t = parts[p].first_triangle; t < mesh.triangles.size(); ++t) {
      if (part_of(t) != p || place++ % step != 0) continue;
      const std::array<Vector3, 3> corners = mesh.corners(t);
      Vector3& point = points.emplace_back();
      for (std::size_t a = 0; a < 3; ++a) {
        point[a] = corners[0][a] / 3.0 + corners[1][a] / 3.0 + corners[2][a] / 3.0;
      }
      if (points.size() == count) break;
    }
    return points;
  };
  std::vector<bool> is_turned(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const bool is_mixed = parts[p].is_mixed;
    is_turned[p] = ways[p] < 0.0;
    if (!is_mixed && ways[p] * parts[p].volume >= 0.0) continue;
    const Progress part =
        progress.part(static_cast<double>(p) / static_cast<double>(parts.size()),
                      static_cast<double>(p + 1) / static_cast<double>(parts.size()));
    bool is_held = true;
    for (const Vector3& point : points_of(p, is_mixed ? kPoints : 1)) {
      std::vector<bool> may_hold(parts.size() + 1, false);
      bool may_be_held = false;
      for (std::size_t q = 0; q < parts.size(); ++q) {
        may_hold[q] = q != p && parts[q].box.squared_distance(point) == 0.0;
        may_be_held = may_be_held || may_hold[q];
      }
      if (!may_be_held) {
        is_held = false;
      } else if (is_mixed) {
        const auto count =
            static_cast<std::int64_t>(std::floor(winding(point, may_hold, outward, part) + 0.5));
        is_held = is_held && count % 2 != 0;
      } else {
        is_held = winding(point, may_hold, ways, part) >= 0.5;
      }
      if (!is_held) break;
    }
    // Mixed parts are right side out by now, the others inside out.
    if (is_held == is_mixed) is_turned[p] = !is_turned[p];
  }
  progress.report(1.0);
  return is_turned;
}

}  // namespace prefilter
