// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/relax_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

constexpr std::int64_t kRelaxPlacesLoopsPerTask = 1024;
constexpr int kRelaxPlacesPasses = 5;
constexpr double kStep = 0.5;  // share of the way to the mean
// minimum weight of a vertex's original corner weights in its new position
constexpr double kLeastOwn = 0.25;
// minimum cosine between the normals around a loop that counts as smooth
constexpr double kRelaxPlacesLeastCosine = 0.5;

// The triangles between a vertex and the sides of its loop, as heights over the tangent plane at
// the vertex.
class Fan {
 public:
  Fan(std::span<const std::int32_t> loop, const std::vector<Vector3>& positions,
      const std::vector<Vector3>& normals, const Vector3& middle)
      : loop_(loop), positions_(positions), normals_(normals), middle_(middle) {
    for (const std::int32_t v : loop) up_ = up_ + normals[static_cast<std::size_t>(v)];
    const double size = std::sqrt(dot(up_, up_));
    if (size > 0.0) up_ = (1.0 / size) * up_;
  }

  // Whether the loop winds once around the vertex, projected along the normal, and is not steep.
  bool is_flat() const {
    for (std::size_t k = 0; k < loop_.size(); ++k) {
      if (!(dot(normals_[corner(k)], up_) >= kRelaxPlacesLeastCosine)) return false;
      if (!(area(arm(k), arm(k + 1)) > 0.0)) return false;
    }
    return true;
  }

  // The point of the surface above another point. Halfway between the triangles and the tangent
  // planes at their corners, which is exact for quadrics.
  Vector3 point_over(const Vector3& wanted) const {
    Vector3 offset = wanted - middle_;
    offset = offset - dot(offset, up_) * up_;
    for (std::size_t k = 0; k < loop_.size(); ++k) {
      const Vector3 a = arm(k);
      const Vector3 b = arm(k + 1);
      const double of_a = area(offset, b);
      const double of_b = area(a, offset);
      if (!(of_a >= 0.0 && of_b >= 0.0)) continue;
      const double whole = area(a, b);
      const double share = (of_a + of_b) / whole;
      const double scale = share > 1.0 - kLeastOwn ? (1.0 - kLeastOwn) / share : 1.0;
      return over(scale * offset, k, scale * of_a / whole, scale * of_b / whole);
    }
    return middle_;
  }

 private:
  std::size_t corner(std::size_t k) const {
    return static_cast<std::size_t>(loop_[k % loop_.size()]);
  }
  Vector3 arm(std::size_t k) const { return positions_[corner(k)] - middle_; }

  // Projected area of the parallelogram of two arms.
  double area(const Vector3& a, const Vector3& b) const { return dot(cross(a, b), up_); }

  Vector3 over(const Vector3& offset, std::size_t k, double first, double second) const {
    double height = 0.0;
    for (const auto& [at, weight] : {std::pair(k, first), std::pair(k + 1, second)}) {
      const Vector3& normal = normals_[corner(at)];
      const double tangent = dot(normal, arm(at) - offset) / dot(normal, up_);
      height += 0.5 * weight * (dot(arm(at), up_) + tangent);
    }
    return middle_ + offset + height * up_;
  }

  std::span<const std::int32_t> loop_;
  const std::vector<Vector3>& positions_;
  const std::vector<Vector3>& normals_;
  Vector3 middle_;
  Vector3 up_{};
};

// For each corner of a loop the next loop around it; together, these are the adjacent loops.
std::vector<std::int32_t> loops_beside(const DualLoops& loops) {
  std::vector<std::int32_t> beside;
  beside.reserve(loops.corners.size());
  for (std::size_t i = 0; i < loops.size(); ++i) {
    for (const std::int32_t v : loops.loop(i)) {
      const auto& around = loops.quads[static_cast<std::size_t>(v)];
      const auto at = std::find(around.begin(), around.end(), static_cast<std::int32_t>(i));
      beside.push_back(around[static_cast<std::size_t>(at - around.begin() + 1) % 4]);
    }
  }
  return beside;
}
}  // namespace

void relax_places(const DualLoops& loops, const std::vector<Vector3>& positions,
                  const std::vector<Vector3>& normals, const Run& run, DualPlaces* places) {
  const std::vector<std::int32_t> beside = loops_beside(loops);
  const std::vector<Vector3> first = places->positions;
  const auto fan_of = [&](std::size_t i) {
    return Fan(loops.loop(i), positions, normals, first[i]);
  };
  const auto for_loops = [&](const Run& part, const auto& visit) {
    parallel_ranges(static_cast<std::int64_t>(loops.size()), kRelaxPlacesLoopsPerTask, part,
                    [&](std::int64_t begin, std::int64_t end) {
                      for (auto i = static_cast<std::size_t>(begin);
                           i < static_cast<std::size_t>(end); ++i) {
                        visit(i);
                      }
                    });
  };
  std::vector<std::uint8_t> moves(loops.size());
  for_loops(run.part(0.0, 0.2), [&](std::size_t i) {
    moves[i] = places->is_sharp[i] == 0 && fan_of(i).is_flat() ? 1 : 0;
  });
  std::vector<Vector3> moved = first;
  for (int pass = 0; pass < kRelaxPlacesPasses; ++pass) {
    const double begin = 0.2 + 0.8 * pass / kRelaxPlacesPasses;
    for_loops(run.part(begin, begin + 0.8 / kRelaxPlacesPasses), [&](std::size_t i) {
      if (moves[i] == 0) return;
      Vector3 sum{};
      for (std::uint32_t k = loops.begins[i]; k < loops.begins[i + 1]; ++k) {
        sum = sum + places->positions[static_cast<std::size_t>(beside[k])];
      }
      const Vector3 mean = (1.0 / static_cast<double>(loops.loop(i).size())) * sum;
      moved[i] = fan_of(i).point_over((1.0 - kStep) * places->positions[i] + kStep * mean);
    });
    std::swap(moved, places->positions);
  }
}

}  // namespace prefilter
