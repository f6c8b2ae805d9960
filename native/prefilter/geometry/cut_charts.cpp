// SPDX-License-Identifier: GPL-3.0-or-later

// Shortest paths from both sides of each slit divide a chart half way between them.
#include "prefilter/geometry/cut_charts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

namespace prefilter {
namespace {

constexpr float kSeamTolerance = 1e-4F;
// Work limit, in visited triangles per triangle of the mesh. Slits that remain then are separated
// triangle by triangle.
constexpr std::size_t kMaxVisitsPerTriangle = 40;

Vector3 middle_of(const InputMesh& mesh, std::uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const auto at = [&](auto vertex) { return mesh.positions[static_cast<std::size_t>(vertex)]; };
  return (1.0 / 3.0) * (at(a) + at(b) + at(c));
}

// Divides charts at slits, half way between their sides.
class SlitSplitter {
 public:
  SlitSplitter(const InputMesh& mesh, const ChartLinks& links, std::vector<std::int32_t>* charts)
      : mesh_(mesh),
        links_(links),
        charts_(*charts),
        distances_(charts->size(), std::numeric_limits<double>::infinity()),
        side_(charts->size()) {
    next_ = *std::max_element(charts_.begin(), charts_.end()) + 1;
  }

  void run(const Run& run) {
    const std::size_t most = kMaxVisitsPerTriangle * charts_.size();
    for (const auto& [left, right] : links_.slits) {
      if (charts_[left] != charts_[right]) continue;
      if (visits_ > most) break;
      separate(left, right);
      run.report(static_cast<double>(visits_) / static_cast<double>(most));
    }
  }

 private:
  // Gives the triangles closer to `right` than to `left` a new number.
  void separate(std::uint32_t left, std::uint32_t right) {
    visit(left, 0.0, 0);
    visit(right, 0.0, 1);
    while (!queue_.empty()) {
      const auto [distance, triangle, side] = queue_.top();
      queue_.pop();
      if (distance != distances_[triangle] || side != side_[triangle]) continue;
      const Vector3 middle = middle_of(mesh_, triangle);
      for (const std::int32_t beyond : links_.beyond[triangle]) {
        if (beyond < 0) continue;
        const auto to = static_cast<std::uint32_t>(beyond);
        if (charts_[to] != charts_[triangle]) continue;
        visit(to, distance + length(middle_of(mesh_, to) - middle), side);
      }
    }
    for (const std::uint32_t triangle : reached_) {
      distances_[triangle] = std::numeric_limits<double>::infinity();
      if (side_[triangle] == 1) charts_[triangle] = next_;
    }
    ++next_;
    visits_ += reached_.size();
    reached_.clear();
  }

  void visit(std::uint32_t triangle, double distance, int side) {
    if (distance >= distances_[triangle]) return;
    if (std::isinf(distances_[triangle])) reached_.push_back(triangle);
    distances_[triangle] = distance;
    side_[triangle] = side;
    queue_.emplace(distance, triangle, side);
  }

  using Step = std::tuple<double, std::uint32_t, int>;

  const InputMesh& mesh_;
  const ChartLinks& links_;
  std::vector<std::int32_t>& charts_;
  std::int32_t next_ = 0;
  std::vector<double> distances_;
  std::vector<int> side_;
  std::vector<std::uint32_t> reached_;
  std::size_t visits_ = 0;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> queue_;
};

// Grows pieces with a unique pair of UVs at each vertex.
class PieceGrower {
 public:
  PieceGrower(const InputMesh& mesh, std::span<const CornerUvs> maps,
              std::span<const std::uint32_t> place, const ChartLinks& links)
      : mesh_(mesh), maps_(maps), place_(place), links_(links), claimed_(place.size(), {-1, 0}) {}

  std::vector<std::int32_t> run(std::span<const std::int32_t> charts) {
    std::vector<std::int32_t> pieces(charts.size(), -1);
    for (std::uint32_t first = 0; first < charts.size(); ++first) {
      if (pieces[first] >= 0) continue;
      std::vector<std::uint32_t> found{first};
      pieces[first] = next_;
      claim(first);
      for (std::size_t i = 0; i < found.size(); ++i) {
        for (const std::int32_t beyond : links_.beyond[found[i]]) {
          if (beyond < 0) continue;
          const auto to = static_cast<std::uint32_t>(beyond);
          if (pieces[to] >= 0 || charts[to] != charts[first] || !fits(to)) continue;
          pieces[to] = next_;
          claim(to);
          found.push_back(to);
        }
      }
      ++next_;
    }
    return pieces;
  }

 private:
  std::size_t vertex(std::uint32_t triangle, std::size_t corner) const {
    return place_[static_cast<std::size_t>(mesh_.triangles[triangle][corner])];
  }

  bool fits(std::uint32_t triangle) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& [piece, corner] = claimed_[vertex(triangle, i)];
      if (piece != next_) continue;
      const std::size_t right = corner / 3;
      const std::size_t at = corner % 3;
      for (const CornerUvs& map : maps_) {
        if (!are_near_uvs(map[triangle][i], map[right][at])) return false;
      }
    }
    return true;
  }

  void claim(std::uint32_t triangle) {
    for (std::size_t i = 0; i < 3; ++i) claimed_[vertex(triangle, i)] = {next_, 3 * triangle + i};
  }

  const InputMesh& mesh_;
  std::span<const CornerUvs> maps_;
  std::span<const std::uint32_t> place_;
  const ChartLinks& links_;
  std::int32_t next_ = 0;
  std::vector<std::pair<std::int32_t, std::size_t>> claimed_;  // by vertex: a piece, and its corner
};

}  // namespace

bool are_near_uvs(const std::array<float, 2>& a, const std::array<float, 2>& b) {
  return std::abs(a[0] - b[0]) <= kSeamTolerance && std::abs(a[1] - b[1]) <= kSeamTolerance;
}

void cut_charts(const InputMesh& mesh, std::span<const CornerUvs> maps,
                std::span<const std::uint32_t> place, const ChartLinks& links, const Run& run,
                std::vector<std::int32_t>* charts) {
  SlitSplitter(mesh, links, charts).run(run);
  *charts = PieceGrower(mesh, maps, place, links).run(*charts);
  run.report(1.0);
}

}  // namespace prefilter
