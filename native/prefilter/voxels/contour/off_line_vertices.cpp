// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/off_line_vertices.h"

#include <algorithm>
#include <optional>

namespace prefilter {
namespace {

constexpr std::uint8_t kMostMoves = 3;
constexpr double kOffLineVerticesReachCells = 1.0;
constexpr double kBeyondCells = 0.1;

using Triangle = std::array<std::int32_t, 3>;

// The sample of a vertex whose line misses the surface; -1 for all other vertices.
std::int32_t off_line(std::int32_t vertex, const VertexSamples& samples,
                      std::span<const Vector3> positions) {
  const auto v = static_cast<std::size_t>(vertex);
  if (v >= samples.index.size() || samples.index[v] < 0) return -1;
  const auto sample = static_cast<std::size_t>(samples.index[v]);
  const bool is_off = samples.samples[sample].position != samples.on_lines[sample];
  return is_off && positions[v] != samples.on_lines[sample] ? samples.index[v] : -1;
}

}  // namespace

bool OffLineVertices::take(const Triangle& triangle, std::span<const Vector3> positions) {
  bool is_any = false;
  for (const std::int32_t corner : triangle) {
    const std::int32_t sample = off_line(corner, samples_, positions);
    if (sample < 0 || moves_[static_cast<std::size_t>(sample)] > kMostMoves) continue;
    taken_.push_back(corner);
    is_any = true;
  }
  return is_any;
}

void OffLineVertices::move(std::span<const Triangle> triangles, std::vector<std::uint8_t>* is_moved,
                           std::vector<Vector3>* positions) {
  if (taken_.empty()) return;
  std::sort(taken_.begin(), taken_.end());
  taken_.erase(std::unique(taken_.begin(), taken_.end()), taken_.end());
  const std::vector<Around> around = look_around(triangles, *positions);
  for (std::size_t k = 0; k < taken_.size(); ++k) {
    const auto v = static_cast<std::size_t>(taken_[k]);
    (*positions)[v] = next_place((*positions)[v], around[k], samples_.index[v]);
    (*is_moved)[v] = 1;
  }
  taken_.clear();
}

Vector3 OffLineVertices::next_place(const Vector3& from, const Around& around, std::int32_t index) {
  const auto sample = static_cast<std::size_t>(index);
  if (moves_[sample]++ < kMostMoves) {
    const bool is_over = around.across != Vector3{};
    const Vector3 way = is_over ? around.across : 0.5 * (around.mean - from);
    const std::optional<SourcePoint> found = surface_.nearest(
        from + way, kOffLineVerticesReachCells * surface_.cell(), samples_.samples[sample].label);
    if (found) return found->position;
  }
  return samples_.on_lines[sample];
}

std::vector<OffLineVertices::Around> OffLineVertices::look_around(
    std::span<const Triangle> triangles, std::span<const Vector3> positions) const {
  std::vector<Around> around(taken_.size());
  std::vector<double> counts(taken_.size(), 0.0);
  const auto at = [&](std::int32_t v) -> const Vector3& {
    return positions[static_cast<std::size_t>(v)];
  };
  for (const Triangle& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto found = std::lower_bound(taken_.begin(), taken_.end(), triangle[k]);
      if (found == taken_.end() || *found != triangle[k]) continue;
      const auto i = static_cast<std::size_t>(found - taken_.begin());
      const Vector3& a = at(triangle[(k + 1) % 3]);
      const Vector3& b = at(triangle[(k + 2) % 3]);
      around[i].mean = around[i].mean + a + b;
      counts[i] += 2.0;
      const Vector3 way = way_across(triangle[k], at(triangle[k]), a, b);
      if (dot(way, way) > dot(around[i].across, around[i].across)) around[i].across = way;
    }
  }
  for (std::size_t i = 0; i < around.size(); ++i) {
    around[i].mean = (1.0 / std::max(counts[i], 1.0)) * around[i].mean;
  }
  return around;
}

// Direction, within the plane of the vertex's sample, from the vertex to beyond the line through
// two other vertices if their triangle is upside down; otherwise 0.
Vector3 OffLineVertices::way_across(std::int32_t vertex, const Vector3& from, const Vector3& a,
                                    const Vector3& b) const {
  const SourcePoint& sample = *samples_.of(vertex);
  const Vector3 up = turned_.contains(sample.label) ? -1.0 * sample.normal : sample.normal;
  const Vector3 inward = cross(up, b - a);
  const double size = length(inward);
  const double height = size > 0.0 ? dot(inward, from - a) / size : 0.0;
  if (!(height < 0.0)) return {};
  return ((kBeyondCells * surface_.cell() - height) / size) * inward;
}

}  // namespace prefilter
