// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/patch_division.h"

#include <atomic>
#include <bit>
#include <cmath>
#include <numeric>

#include "prefilter/base/parallel.h"
#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/voxels/remesh/patch.h"

namespace prefilter {
namespace {

using Triangle = std::array<std::int32_t, 3>;

std::vector<std::uint32_t> order_along_curve(std::span<const Vector3> positions,
                                             std::span<const Triangle> triangles, int number,
                                             const Run& run) {
  Box box = kEmptyBox;
  for (const Vector3& p : positions) box.include(p);
  const double size = std::max({box.size(0), box.size(1), box.size(2)});
  const std::size_t count = triangles.size();
  const int bits = std::clamp(static_cast<int>(std::bit_width(count / 32)) / 2 + 1, 1, 7);
  const double whole = std::ldexp(1.0, bits);
  const double shift = number * 0.381966 - std::floor(number * 0.381966);
  std::vector<std::uint32_t> keys(count);
  constexpr std::int64_t kGrain = 1 << 15;
  const auto set_keys = [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t t = begin; t < end; ++t) {
      const Vector3& p = positions[as_index(triangles[static_cast<std::size_t>(t)][0])];
      std::array<int, 3> cell;
      for (int a = 0; a < 3; ++a) {
        const double along = ((p[a] - box.low[a]) / size + shift) / 2.0;
        cell[a] = std::clamp(static_cast<int>(along * whole), 0, (1 << bits) - 1);
      }
      keys[static_cast<std::size_t>(t)] = static_cast<std::uint32_t>(morton_index(cell));
    }
  };
  parallel_ranges(static_cast<std::int64_t>(count), kGrain, run, set_keys);
  std::vector<std::uint32_t> begins((std::size_t{1} << (3 * bits)) + 1, 0);
  for (const std::uint32_t key : keys) ++begins[key + 1];
  for (std::size_t i = 1; i < begins.size(); ++i) begins[i] += begins[i - 1];
  std::vector<std::uint32_t> order(count);
  for (std::size_t t = 0; t < count; ++t) order[begins[keys[t]]++] = static_cast<std::uint32_t>(t);
  return order;
}

void find_owners(std::span<const Triangle> triangles, const Run& run, PatchDivision* division) {
  const auto own = [&](std::int64_t patch) {
    const auto owner = static_cast<std::int32_t>(patch);
    for (const std::uint32_t t : division->triangles(static_cast<std::size_t>(patch))) {
      for (const std::int32_t v : triangles[t]) {
        const std::atomic_ref<std::int32_t> vertex_owner(division->owners[as_index(v)]);
        std::int32_t before = vertex_owner.load(std::memory_order_relaxed);
        if (before == owner || before == PatchDivision::kShared) continue;
        if (before == PatchDivision::kUnowned &&
            vertex_owner.compare_exchange_strong(before, owner, std::memory_order_relaxed)) {
          continue;
        }
        vertex_owner.store(PatchDivision::kShared, std::memory_order_relaxed);
      }
    }
  };
  parallel_for(static_cast<std::int64_t>(division->count()), run, own);
}
}  // namespace

PatchDivision divide_into_patches(std::span<const Vector3> positions,
                                  std::span<const Triangle> triangles, int number, const Run& run) {
  PatchDivision division;
  const Stages stages(run, {7, 3});
  if (triangles.size() <= PatchDivision::kTriangles) {
    division.order.resize(triangles.size());
    std::iota(division.order.begin(), division.order.end(), 0U);
  } else {
    division.order = order_along_curve(positions, triangles, number, stages[0]);
  }
  division.owners.assign(positions.size(), PatchDivision::kUnowned);
  find_owners(triangles, stages[1], &division);
  return division;
}

}  // namespace prefilter
