// SPDX-License-Identifier: GPL-3.0-or-later

// Union-find over the edges that are not seams.
#include "prefilter/geometry/charts.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/sort.h"
#include "prefilter/geometry/cut_charts.h"

namespace prefilter {
namespace {

// A side of a triangle; `half` is three times the triangle plus the corner where the side starts.
struct Side {
  std::uint64_t ends;  // the lower vertex in the high bits
  std::uint32_t half;

  bool operator<(const Side& other) const {
    return ends != other.ends ? ends < other.ends : half < other.half;
  }
};

// For each vertex, the first vertex at its position.
std::vector<std::uint32_t> welded(const PositionView& positions, const Run& run) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  sort_in_parallel(&order, run, [&](std::uint32_t a, std::uint32_t b) {
    const Vector3 p = positions[a];
    const Vector3 q = positions[b];
    return p != q ? p < q : a < b;
  });
  std::vector<std::uint32_t> firsts(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    firsts[order[i]] = is_same ? firsts[order[i - 1]] : order[i];
  }
  return firsts;
}

class Sets {
 public:
  explicit Sets(std::size_t count) : above_(count) { std::iota(above_.begin(), above_.end(), 0U); }

  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    above_[std::max(a, b)] = std::min(a, b);
  }

  std::vector<std::int32_t> numbers() {
    std::vector<std::int32_t> result(above_.size());
    std::int32_t next = 0;
    for (std::uint32_t i = 0; i < above_.size(); ++i) {
      const std::uint32_t first = root(i);
      result[i] = first == i ? next++ : result[first];
    }
    return result;
  }

 private:
  std::uint32_t root(std::uint32_t i) {
    while (above_[i] != i) {
      above_[i] = above_[above_[i]];
      i = above_[i];
    }
    return i;
  }

  std::vector<std::uint32_t> above_;
};

}  // namespace

std::vector<std::int32_t> find_charts(const InputMesh& mesh, std::span<const CornerUvs> maps,
                                      const Run& run) {
  check_mesh(mesh, kLargestCoordinate);
  for (const CornerUvs& map : maps) {
    if (map.size() == mesh.triangles.size()) continue;
    throw_invalid("uvs: found " + std::to_string(map.size()) + " for " +
                  std::to_string(mesh.triangles.size()) + " triangles; one each is needed");
  }
  const Stages stages(run, {3, 4, 3});
  const std::vector<std::uint32_t> first = welded(mesh.positions, stages[0]);
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto triangle = mesh.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(first[static_cast<std::size_t>(triangle[i])],
                                           first[static_cast<std::size_t>(triangle[(i + 1) % 3])]);
      sides.push_back(
          {(static_cast<std::uint64_t>(low) << 32U) | high, static_cast<std::uint32_t>(3 * t + i)});
    }
  }
  sort_in_parallel(&sides, stages[1]);

  Sets charts(mesh.triangles.size());
  ChartLinks links{{mesh.triangles.size(), {-1, -1, -1}}, {}};
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    end = i + 1;
    while (end < sides.size() && sides[end].ends == sides[i].ends) ++end;
    if (end != i + 2) continue;
    const std::uint32_t t = sides[i].half / 3;
    const std::uint32_t u = sides[i + 1].half / 3;
    const std::uint32_t from = sides[i].half % 3;
    const std::uint32_t to = (from + 1) % 3;
    std::uint32_t other_from = sides[i + 1].half % 3;
    std::uint32_t other_to = (other_from + 1) % 3;
    const auto place = [&](std::uint32_t triangle, std::uint32_t corner) {
      return first[static_cast<std::size_t>(mesh.triangles[triangle][corner])];
    };
    if (place(t, from) != place(u, other_from)) std::swap(other_from, other_to);
    const auto are_same = [&](std::uint32_t corner, std::uint32_t other) {
      return std::all_of(maps.begin(), maps.end(), [&](const CornerUvs& map) {
        return are_near_uvs(map[t][corner], map[u][other]);
      });
    };
    const bool begins = are_same(from, other_from);
    const bool ends = are_same(to, other_to);
    if (begins && ends) {
      charts.join(t, u);
      links.beyond[t][sides[i].half % 3] = static_cast<std::int32_t>(u);
      links.beyond[u][sides[i + 1].half % 3] = static_cast<std::int32_t>(t);
    } else if (!begins && !ends) {
      links.slits.push_back({t, u});
    }
  }
  std::vector<std::int32_t> result = charts.numbers();
  cut_charts(mesh, maps, first, links, stages[2], &result);
  return result;
}

}  // namespace prefilter
