// SPDX-License-Identifier: GPL-3.0-or-later

// The triangles of a loop are the triangles of one cube that share vertices. Keeps the surroundings
// of the loop, and finds its triangulation with the least sum of edge costs by dynamic programming
// over diagonals.
#include "prefilter/voxels/contour/unfolded_loops.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>

#include "prefilter/voxels/remesh/folds.h"

namespace prefilter {
namespace {

constexpr std::size_t kUnfoldedLoopsMost = 12;  // corners of a loop
constexpr double kFoldCost = 1e6;

using Triangle = std::array<std::int32_t, 3>;

// The low corner of the cube that contains a triangle; none if it has a vertex without a grid
// position, or lies in a face.
std::optional<GridPlace> cube_of(const Triangle& triangle, std::span<const GridPlace> places) {
  GridPlace low;
  GridPlace high;
  low.fill(std::numeric_limits<std::int32_t>::max());
  high.fill(std::numeric_limits<std::int32_t>::min());
  for (const std::int32_t v : triangle) {
    const GridPlace& place = places[static_cast<std::size_t>(v)];
    if (place == kNoPlace) return std::nullopt;
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], place[a]);
      high[a] = std::max(high[a], place[a]);
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    if (low[a] % 2 == 0) {
      --low[a];
    } else if (low[a] == high[a]) {
      return std::nullopt;
    }
    if (high[a] > low[a] + 2) return std::nullopt;
  }
  return low;
}

bool is_in_face(const GridPlace& place, const GridPlace& other) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (place[a] == other[a] && place[a] % 2 != 0) return true;
  }
  return false;
}

// Cost of an edge between two normals.
double edge_cost(const Vector3& normal, const Vector3& other) {
  const double sizes = std::sqrt(dot(normal, normal) * dot(other, other));
  if (!(sizes > 0.0)) return kFoldCost;
  const double cosine = dot(normal, other) / sizes;
  return (cosine < kFold ? kFoldCost : 0.0) + (1.0 - cosine) * (1.0 - cosine);
}

// A loop's corners, in the order of its triangles, the normals around it, and the allowed
// diagonals.
class Loop {
 public:
  std::size_t count = 0;
  std::array<std::int32_t, kUnfoldedLoopsMost> corners;
  std::array<Vector3, kUnfoldedLoopsMost> positions;
  std::array<Vector3, kUnfoldedLoopsMost> around;  // across the side from each corner; 0 if none
  std::array<std::array<bool, kUnfoldedLoopsMost>, kUnfoldedLoopsMost> is_free;

  Vector3 normal(std::size_t i, std::size_t k, std::size_t j) const {
    return cross(positions[k] - positions[i], positions[j] - positions[i]);
  }

  // Cost of the side from i to the next corner; 0 if nothing is across it.
  double side_cost(std::size_t i, const Vector3& normal) const {
    return around[i] == Vector3{} ? 0.0 : edge_cost(normal, around[i]);
  }
};

// The best triangulation of a loop.
class Triangulation {
 public:
  explicit Triangulation(const Loop& loop) : loop_(loop) {
    for (std::size_t span = 2; span < loop.count; ++span) {
      for (std::size_t i = 0; i + span < loop.count; ++i) {
        for (std::size_t k = i + 1; k < i + span; ++k) choose(i, k, i + span);
      }
    }
    const std::size_t last = loop.count - 1;
    for (std::size_t k = 1; k < last; ++k) {
      const double sum = least_[0][k][last] + loop.side_cost(last, loop.normal(0, k, last));
      if (!(sum < cost_)) continue;
      cost_ = sum;
      top_ = k;
    }
  }

  double cost() const { return cost_; }

  // Calls add(i, k, j) for each triangle.
  template <typename Add>
  void for_triangles(const Add& add) const {
    visit(0, top_, loop_.count - 1, add);
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  // Cost of the triangle over (i, j) with corner k, including all triangles between it and the
  // loop.
  void choose(std::size_t i, std::size_t k, std::size_t j) {
    double& sum = least_[i][k][j];
    sum = kNever;
    if (!(i == 0 && j + 1 == loop_.count) && !loop_.is_free[i][j]) return;
    const Vector3 normal = loop_.normal(i, k, j);
    sum = best(i, k, normal, &low_[i][k][j]) + best(k, j, normal, &high_[i][k][j]);
  }

  // Best cost over the side (i, j) of a triangle.
  double best(std::size_t i, std::size_t j, const Vector3& normal, std::uint8_t* apex) const {
    if (j == i + 1) return loop_.side_cost(i, normal);
    double least = kNever;
    for (std::size_t k = i + 1; k < j; ++k) {
      if (least_[i][k][j] == kNever) continue;
      const double sum = least_[i][k][j] + edge_cost(normal, loop_.normal(i, k, j));
      if (!(sum < least)) continue;
      least = sum;
      *apex = static_cast<std::uint8_t>(k);
    }
    return least;
  }

  template <typename Add>
  void visit(std::size_t i, std::size_t k, std::size_t j, const Add& add) const {
    add(i, k, j);
    if (k > i + 1) visit(i, low_[i][k][j], k, add);
    if (j > k + 1) visit(k, high_[i][k][j], j, add);
  }

  template <typename T>
  using Table = std::array<std::array<std::array<T, kUnfoldedLoopsMost>, kUnfoldedLoopsMost>,
                           kUnfoldedLoopsMost>;

  const Loop& loop_;
  Table<double> least_;
  Table<std::uint8_t> low_;
  Table<std::uint8_t> high_;
  double cost_ = kNever;
  std::size_t top_ = 0;
};

using Numbers = std::vector<std::uint32_t>;
using UnfoldedLoopsSide = std::array<std::int32_t, 2>;

// The triangles of cubes, and the triangles at their sides.
class Cubes {
 public:
  Cubes(std::span<const Vector3> positions, std::span<const GridPlace> places,
        std::span<const std::array<std::uint32_t, 2>> pairs, std::vector<Triangle>* triangles)
      : positions_(positions), places_(places), triangles_(*triangles) {
    std::vector<std::uint8_t> is_near(positions.size(), 0);
    for (const auto& pair : pairs) {
      for (const std::uint32_t t : pair) {
        const auto cube = cube_of(triangles_[t], places_);
        if (cube) in_cubes_[*cube];
      }
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const auto cube = cube_of(triangles_[t], places_);
      const auto found = cube ? in_cubes_.find(*cube) : in_cubes_.end();
      if (found == in_cubes_.end()) continue;
      found->second.push_back(static_cast<std::uint32_t>(t));
      for (const std::int32_t v : triangles_[t]) is_near[static_cast<std::size_t>(v)] = 1;
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const UnfoldedLoopsSide side = {triangles_[t][k], triangles_[t][(k + 1) % 3]};
        const bool is_side = (is_near[static_cast<std::size_t>(side[0])] &
                              is_near[static_cast<std::size_t>(side[1])]) != 0;
        if (is_side) at_sides_[side] = static_cast<std::uint32_t>(t);
      }
    }
  }

  bool unfold() {
    bool has_changed = false;
    for (auto& [cube, numbers] : in_cubes_) {
      while (!numbers.empty()) has_changed |= unfold_loop(take_loop(&numbers));
    }
    return has_changed;
  }

 private:
  // The triangles of a cube that form one loop.
  Numbers take_loop(Numbers* numbers) const {
    Numbers loop = {numbers->back()};
    numbers->pop_back();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Triangle& triangle = triangles_[loop[i]];
      std::erase_if(*numbers, [&](std::uint32_t t) {
        const bool is_beside =
            std::find_first_of(triangle.begin(), triangle.end(), triangles_[t].begin(),
                               triangles_[t].end()) != triangle.end();
        if (is_beside) loop.push_back(t);
        return is_beside;
      });
    }
    std::sort(loop.begin(), loop.end());
    return loop;
  }

  Vector3 normal_of(std::uint32_t t) const {
    const auto [a, b, c] = MeshView<std::int32_t>{positions_, triangles_}.corners(t);
    return cross(b - a, c - a);
  }

  // The loop of triangles that form a disk.
  std::optional<Loop> loop_of(const Numbers& numbers) const {
    std::map<std::int32_t, std::int32_t> next;
    for (const std::uint32_t t : numbers) {
      for (std::size_t k = 0; k < 3; ++k) {
        const UnfoldedLoopsSide side = {triangles_[t][k], triangles_[t][(k + 1) % 3]};
        const auto other = at_sides_.find({side[1], side[0]});
        const bool is_inner = other != at_sides_.end() &&
                              std::binary_search(numbers.begin(), numbers.end(), other->second);
        if (is_inner) continue;
        if (!next.emplace(side[0], side[1]).second) return std::nullopt;
      }
    }
    Loop loop;
    if (next.size() != numbers.size() + 2 || next.size() > kUnfoldedLoopsMost) return std::nullopt;
    for (std::int32_t v = next.begin()->first; loop.count < next.size(); v = next.at(v)) {
      if (loop.count > 0 && v == loop.corners[0]) return std::nullopt;
      loop.corners[loop.count] = v;
      loop.positions[loop.count] = positions_[static_cast<std::size_t>(v)];
      const auto other = at_sides_.find({next.at(v), v});
      loop.around[loop.count] = other == at_sides_.end() ? Vector3{} : normal_of(other->second);
      ++loop.count;
    }
    for (std::size_t i = 0; i < loop.count; ++i) {
      for (std::size_t j = 0; j < loop.count; ++j) {
        loop.is_free[i][j] = !is_in_face(places_[static_cast<std::size_t>(loop.corners[i])],
                                         places_[static_cast<std::size_t>(loop.corners[j])]);
      }
    }
    return loop;
  }

  // The cost of the present triangles.
  double cost_of(const Numbers& numbers) const {
    double sum = 0.0;
    for (const std::uint32_t t : numbers) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto other = at_sides_.find({triangles_[t][(k + 1) % 3], triangles_[t][k]});
        if (other == at_sides_.end()) continue;
        const bool is_inner = std::binary_search(numbers.begin(), numbers.end(), other->second);
        if (is_inner && other->second < t) continue;
        sum += edge_cost(normal_of(t), normal_of(other->second));
      }
    }
    return sum;
  }

  bool unfold_loop(const Numbers& numbers) {
    const std::optional<Loop> loop = loop_of(numbers);
    if (!loop || loop->count < 4) return false;
    const Triangulation best(*loop);
    if (!(best.cost() < cost_of(numbers) - 0.5 * kFoldCost)) return false;
    for (const std::uint32_t t : numbers) {
      for (std::size_t k = 0; k < 3; ++k) {
        at_sides_.erase({triangles_[t][k], triangles_[t][(k + 1) % 3]});
      }
    }
    std::size_t place = 0;
    best.for_triangles([&](std::size_t i, std::size_t k, std::size_t j) {
      const std::uint32_t t = numbers[place++];
      triangles_[t] = {loop->corners[i], loop->corners[k], loop->corners[j]};
      for (std::size_t side = 0; side < 3; ++side) {
        at_sides_[{triangles_[t][side], triangles_[t][(side + 1) % 3]}] = t;
      }
    });
    return true;
  }

  std::span<const Vector3> positions_;
  std::span<const GridPlace> places_;
  std::vector<Triangle>& triangles_;
  std::map<GridPlace, Numbers> in_cubes_;
  std::map<UnfoldedLoopsSide, std::uint32_t> at_sides_;
};

}  // namespace

bool unfold_loops(std::span<const Vector3> positions, std::span<const GridPlace> places,
                  std::span<const std::array<std::uint32_t, 2>> pairs,
                  std::vector<Triangle>* triangles) {
  Cubes cubes(positions, places, pairs, triangles);
  return cubes.unfold();
}

}  // namespace prefilter
