// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/closed_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/disjoint_sets.h"
#include "prefilter/base/parallel.h"
#include "prefilter/voxels/solid/edge_hash.h"
#include "prefilter/voxels/solid/nesting.h"

namespace prefilter {
namespace {

constexpr std::int64_t kClosedPartsRowsPerTask = 1 << 14;

// Component of each vertex, named by its lowest vertex: components are connected by triangles.
std::vector<std::uint32_t> first_vertices(const InputMesh& mesh, const Run& run) {
  DisjointSets<std::uint32_t> parts(mesh.positions.size());
  CancelCheck cancel_check(run);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    cancel_check.step();
    const auto [a, b, c] = mesh.triangles[t];
    parts.join(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
    parts.join(static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c));
  }
  return std::move(parts).roots();
}

bool may_be_the_same(const ClosedPart& a, const ClosedPart& b) {
  return a.triangles == b.triangles && a.box.low == b.box.low && a.box.high == b.box.high;
}

// Whether any two parts could be copies of each other.
bool has_copies(std::vector<ClosedPart> parts) {
  std::sort(parts.begin(), parts.end(), [](const ClosedPart& a, const ClosedPart& b) {
    return std::tie(a.triangles, a.box.low, a.box.high) <
           std::tie(b.triangles, b.box.low, b.box.high);
  });
  return std::adjacent_find(parts.begin(), parts.end(), may_be_the_same) != parts.end();
}

bool is_thin(double volume, double area, double thickness) {
  return 2.0 * volume < thickness * area;
}

// Whether a part, or all parts together including cavities, is thin.
bool has_thin_part(const std::vector<ClosedPart>& parts, double thickness) {
  double volume = 0.0;
  double area = 0.0;
  for (const ClosedPart& part : parts) {
    if (is_thin(std::abs(part.volume), part.area, thickness)) return true;
    volume += part.volume;
    area += part.area;
  }
  return is_thin(volume, area, thickness);
}

}  // namespace

bool is_balanced(const InputMesh& mesh, const Run& run) {
  const auto rows = static_cast<std::int64_t>(mesh.triangles.size());
  std::vector<EdgeHash> sums(static_cast<std::size_t>(range_count(rows, kClosedPartsRowsPerTask)));
  parallel_ranges(rows, kClosedPartsRowsPerTask, run, [&](std::int64_t begin, std::int64_t end) {
    EdgeHash sum;
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
      const auto [a, b, c] = mesh.triangles[t];
      sum += EdgeHash::of(a, b, c);
    }
    sums[static_cast<std::size_t>(begin / kClosedPartsRowsPerTask)] = sum;
  });
  EdgeHash all;
  for (const EdgeHash& sum : sums) all += sum;
  return all.is_zero();
}

bool is_solid(const InputMesh& mesh, double thickness, const Run& run, std::size_t* part_count) {
  *part_count = 0;
  const Stages stages(run, {3, 3, 2, 2});
  if (!is_balanced(mesh, stages[0])) return false;
  const Run counting = stages[1];
  const std::vector<std::uint32_t> part_of = first_vertices(mesh, counting);
  std::vector<ClosedPart> parts;
  // part of each component, at its lowest vertex
  std::vector<std::uint32_t> numbers(mesh.positions.size(), 0);
  std::vector<bool> is_seen(mesh.positions.size(), false);
  std::vector<std::uint32_t> number_of(mesh.triangles.size());
  const Run summing = stages[2];
  CancelCheck cancel_check(summing);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    cancel_check.step();
    const std::uint32_t root = part_of[static_cast<std::size_t>(mesh.triangles[t][0])];
    if (!is_seen[root]) {
      numbers[root] = static_cast<std::uint32_t>(parts.size());
      parts.emplace_back();
      parts.back().first_triangle = t;
    }
    number_of[t] = numbers[root];
    ClosedPart& part = parts[number_of[t]];
    const std::array<Vector3, 3> p = mesh.corners(t);
    const Vector3 origin = mesh.corners(part.first_triangle)[0];
    part.volume += dot(p[0] - origin, cross(p[1] - origin, p[2] - origin)) / 6.0;
    part.area += length(cross(p[1] - p[0], p[2] - p[0])) / 2.0;
    ++part.triangles;
    for (std::size_t i = 0; i < 3; ++i) {
      part.box.include(p[i]);
      const auto v = static_cast<std::size_t>(mesh.triangles[t][i]);
      if (!is_seen[v]) ++part.vertices;
      is_seen[v] = true;
    }
    // The root is a vertex of the part, but may not have been visited yet.
    if (!is_seen[root]) ++part.vertices;
    is_seen[root] = true;
  }
  *part_count = parts.size();
  for (const ClosedPart& part : parts) {
    // A closed surface has about half as many vertices as triangles; a duplicated one has a
    // quarter.
    if (part.vertices * 3 < part.triangles) return false;
  }
  if (has_thin_part(parts, thickness) || has_copies(parts)) return false;
  const std::vector<bool> is_turned = parts_to_turn(mesh, parts, number_of, stages[3]);
  return std::find(is_turned.begin(), is_turned.end(), true) == is_turned.end();
}

}  // namespace prefilter
