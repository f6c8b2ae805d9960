// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/triangle_parts.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/voxels/remesh/patch_editor.h"

namespace prefilter {
namespace {

constexpr std::int64_t kTrianglePartsRowsPerTask = 1 << 15;
// Binary logarithm of the vertices per part, unless there would be too many parts.
constexpr int kPartBits = 14;
constexpr std::size_t kMaxParts = 1 << 10;

using Triangle = std::array<std::int32_t, 3>;

}  // namespace

std::vector<std::uint32_t> TriangleParts::part_numbers(std::size_t count,
                                                       std::uint32_t none) const {
  std::vector<std::uint32_t> part_numbers(count, none);
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    for (const std::uint32_t t : part(i)) part_numbers[t] = static_cast<std::uint32_t>(i);
  }
  return part_numbers;
}

TriangleParts parts_along_vertices(std::span<const Triangle> triangles, std::size_t vertex_count,
                                   const Run& run) {
  int bits = kPartBits;
  while ((vertex_count >> bits) >= kMaxParts) ++bits;
  const std::size_t count = (vertex_count >> bits) + 1;
  const auto part_of = [&](std::size_t t) {
    const Triangle& triangle = triangles[t];
    return static_cast<std::size_t>(std::min({triangle[0], triangle[1], triangle[2]})) >> bits;
  };
  // Offset in each part at which the triangles of a task begin.
  const auto rows = static_cast<std::int64_t>(triangles.size());
  const std::int64_t rows_per_task =
      std::max(kTrianglePartsRowsPerTask, rows / static_cast<std::int64_t>(kMaxParts));
  const auto tasks = static_cast<std::size_t>(range_count(rows, rows_per_task));
  std::vector<std::size_t> places(tasks * count);
  const auto add_up = [&](std::int64_t begin, std::int64_t end) {
    std::size_t* const counts = &places[static_cast<std::size_t>(begin / rows_per_task) * count];
    for (std::int64_t t = begin; t < end; ++t) ++counts[part_of(static_cast<std::size_t>(t))];
  };
  const Stages stages(run, {1, 1});
  parallel_ranges(rows, rows_per_task, stages[0], add_up);
  TriangleParts parts;
  std::size_t next = 0;
  for (std::size_t part = 0; part < count; ++part) {
    for (std::size_t task = 0; task < tasks; ++task) {
      next += std::exchange(places[task * count + part], next);
    }
    parts.begins.push_back(next);
  }
  parts.triangles.resize(triangles.size());
  const auto place = [&](std::int64_t begin, std::int64_t end) {
    std::size_t* const nexts = &places[static_cast<std::size_t>(begin / rows_per_task) * count];
    for (std::int64_t t = begin; t < end; ++t) {
      parts.triangles[nexts[part_of(static_cast<std::size_t>(t))]++] =
          static_cast<std::uint32_t>(t);
    }
  };
  parallel_ranges(rows, rows_per_task, stages[1], place);
  return parts;
}

void find_owners(const TriangleParts& parts, std::span<const Triangle> triangles, const Run& run,
                 std::vector<std::uint32_t>* owners) {
  const auto find = [&](std::int64_t i) {
    const auto part = static_cast<std::uint32_t>(i);
    for (const std::uint32_t t : parts.part(part)) {
      for (const std::int32_t vertex : triangles[t]) {
        std::atomic_ref<std::uint32_t> owner((*owners)[static_cast<std::size_t>(vertex)]);
        std::uint32_t previous = owner.load(std::memory_order_relaxed);
        if (previous == part) continue;
        if (previous == EditedMesh::kUnowned &&
            owner.compare_exchange_strong(previous, part, std::memory_order_relaxed)) {
          continue;
        }
        if (previous != part) owner.store(EditedMesh::kShared, std::memory_order_relaxed);
      }
    }
  };
  parallel_for(static_cast<std::int64_t>(parts.count()), run, find);
}

TriangleParts parts_by_inner_vertices(std::span<const Triangle> triangles,
                                      std::span<const std::uint32_t> chosen,
                                      const std::vector<std::uint8_t>& is_inner,
                                      std::vector<std::uint32_t>* parents) {
  // Union-find: maps each inner vertex to a lower one in its part.
  std::vector<std::uint32_t>& above = *parents;
  for (const std::uint32_t t : chosen) {
    for (const std::int32_t v : triangles[t]) {
      above[static_cast<std::size_t>(v)] = static_cast<std::uint32_t>(v);
    }
  }
  const auto root_of = [&](std::uint32_t v) {
    while (above[v] != v) v = above[v] = above[above[v]];
    return v;
  };
  const auto inner_of = [&](std::uint32_t t) {
    const auto& triangle = triangles[t];
    return static_cast<std::uint32_t>(
        *std::find_if(triangle.begin(), triangle.end(),
                      [&](std::int32_t v) { return is_inner[static_cast<std::size_t>(v)] != 0; }));
  };
  for (const std::uint32_t t : chosen) {
    std::uint32_t root = root_of(inner_of(t));
    for (const std::int32_t v : triangles[t]) {
      if (is_inner[static_cast<std::size_t>(v)] == 0) continue;
      const std::uint32_t other = root_of(static_cast<std::uint32_t>(v));
      above[std::max(root, other)] = std::min(root, other);
      root = std::min(root, other);
    }
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> rooted;
  rooted.reserve(chosen.size());
  for (const std::uint32_t t : chosen) rooted.push_back({root_of(inner_of(t)), t});
  std::sort(rooted.begin(), rooted.end());
  TriangleParts parts;
  for (std::size_t i = 0; i < rooted.size(); ++i) {
    if (i > 0 && rooted[i].first != rooted[i - 1].first) parts.begins.push_back(i);
    parts.triangles.push_back(rooted[i].second);
  }
  if (!rooted.empty()) parts.begins.push_back(rooted.size());
  return parts;
}

}  // namespace prefilter
