// SPDX-License-Identifier: GPL-3.0-or-later

// Winding numbers from solid angles (A. Van Oosterom, J. Strackee, The solid angle of a plane
// triangle, 1983).
#include "prefilter/voxels/solid/nesting.h"

#include <array>
#include <cmath>
#include <numbers>

#include "prefilter/base/elementary.h"
#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

constexpr std::int64_t kRowsOfTask = 1 << 14;
constexpr std::size_t kPointsPerMixedPart = 24;  // number of points tested per mixed part

// Solid angle of a triangle seen from a point, divided by 4 pi; positive from behind.
double winding_of(const std::array<Vector3, 3>& corners, const Vector3& point) {
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

// Sum of all parts' winding numbers, each times its factor.
double winding_around(const InputMesh& mesh, std::span<const std::uint32_t> part_of,
                      std::span<const double> factors, const Vector3& point, const Run& run) {
  const auto rows = static_cast<std::int64_t>(mesh.triangles.size());
  std::vector<double> sums(static_cast<std::size_t>(range_count(rows, kRowsOfTask)), 0.0);
  parallel_ranges(rows, kRowsOfTask, run, [&](std::int64_t begin, std::int64_t end) {
    double& own = sums[static_cast<std::size_t>(begin / kRowsOfTask)];
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
      const double factor = factors[part_of[t]];
      if (factor != 0.0) own += factor * winding_of(mesh.corners(t), point);
    }
  });
  double all = 0.0;
  for (const double own : sums) all += own;
  return all;
}

// Centers of up to `count` triangles of a part.
std::vector<Vector3> points_of(const InputMesh& mesh, std::span<const std::uint32_t> part_of,
                               std::size_t part, const ClosedPart& closed, std::size_t count) {
  // Odd steps, because subdivided meshes have triangles in groups of powers of two.
  const std::size_t step = closed.triangles / count | 1U;
  std::vector<Vector3> points;
  std::size_t place = 0;
  for (std::size_t t = closed.first_triangle; t < mesh.triangles.size(); ++t) {
    if (part_of[t] != part || place++ % step != 0) continue;
    const std::array<Vector3, 3> corners = mesh.corners(t);
    Vector3& point = points.emplace_back();
    for (std::size_t a = 0; a < 3; ++a) {
      point[a] = corners[0][a] / 3.0 + corners[1][a] / 3.0 + corners[2][a] / 3.0;
    }
    if (points.size() == count) break;
  }
  return points;
}

// Factors of the other parts whose boxes contain a point, 0 for the rest; empty if there are none.
std::vector<double> factors_around(std::span<const ClosedPart> parts,
                                   std::span<const double> factors, std::size_t part,
                                   const Vector3& point) {
  std::vector<double> around(parts.size() + 1, 0.0);
  bool is_any = false;
  for (std::size_t q = 0; q < parts.size(); ++q) {
    if (q == part || parts[q].box.squared_distance(point) != 0.0) continue;
    around[q] = factors[q];
    is_any = true;
  }
  if (!is_any) around.clear();
  return around;
}

}  // namespace

std::vector<bool> parts_to_turn(const InputMesh& mesh, std::span<const ClosedPart> parts,
                                std::span<const std::uint32_t> part_of, const Run& run) {
  double sum = 0.0;
  for (const ClosedPart& part : parts) sum += part.is_mixed ? 0.0 : part.volume;
  // Signs of the parts' winding numbers: as they will be, and as if all were oriented outward.
  std::vector<double> signs(parts.size());
  std::vector<double> outward(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    outward[p] = parts[p].volume < 0.0 ? -1.0 : 1.0;
    signs[p] = parts[p].is_mixed ? outward[p] : (sum < 0.0 ? -1.0 : 1.0);
  }
  std::vector<bool> is_turned(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const bool is_mixed = parts[p].is_mixed;
    is_turned[p] = signs[p] < 0.0;
    if (!is_mixed && signs[p] * parts[p].volume >= 0.0) continue;
    const Run part = run.part(static_cast<double>(p) / static_cast<double>(parts.size()),
                              static_cast<double>(p + 1) / static_cast<double>(parts.size()));
    bool is_enclosed = true;
    for (const Vector3& point :
         points_of(mesh, part_of, p, parts[p], is_mixed ? kPointsPerMixedPart : 1)) {
      const std::vector<double> around =
          factors_around(parts, is_mixed ? outward : signs, p, point);
      if (around.empty()) {
        is_enclosed = false;
        break;
      }
      const double winding = winding_around(mesh, part_of, around, point, part);
      const bool is_odd = static_cast<std::int64_t>(std::floor(winding + 0.5)) % 2 != 0;
      is_enclosed = is_mixed ? is_odd : winding >= 0.5;
      if (!is_enclosed) break;
    }
    // At this point mixed parts are oriented outward, the others inward.
    if (is_enclosed == is_mixed) is_turned[p] = !is_turned[p];
  }
  run.report(1.0);
  return is_turned;
}

}  // namespace prefilter
