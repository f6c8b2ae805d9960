// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxel/thin_places.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/spatial/triangle_pieces.h"
#include "prefilter/spatial/winding_numbers.h"
#include "prefilter/voxel/cube_keys.h"
#include "prefilter/voxel/inner_balls.h"
#include "prefilter/voxel/opposed_bricks.h"

namespace prefilter {
namespace {

constexpr double kPiece = 1.0;         // the longest side of a piece, in cells
constexpr double kLargestPiece = 4.0;  // of one that is as thin everywhere
constexpr double kLeastBrick = 2.0;    // in cells
constexpr double kOpposite = -0.85;  // the cosine between normals of what is opposite: 148 degrees
constexpr double kClear = 1.2;       // from a surface, in cells: what is empty there is outside
constexpr std::array<double, 3> kFarther = {2.1, 3.0, 3.9};  // likewise, where it is not
// How much thicker than a plate that cells hold together a rod and a speck have to be: the quarter
// of a disc that cells have of a rod along their common edge, and the eighth of a ball at their
// common corner, are half of a cell.
constexpr double kRod = 0.23;
constexpr double kSpeck = 0.17;
constexpr double kFarRadii = 2.0;  // of winding numbers that are compared with a half
constexpr std::int64_t kTrianglesPerTask = 1 << 6;

bool is_small(const std::array<Vector3, 3>& p) {
  return std::max({length(p[1] - p[0]), length(p[2] - p[1]), length(p[0] - p[2])}) <= kPiece;
}

std::vector<Vector3> normals_of(const MeshView<std::int32_t>& mesh) {
  std::vector<Vector3> normals(mesh.triangles.size());
  for (std::size_t t = 0; t < normals.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    const Vector3 normal = cross(b - a, c - a);
    const double size = length(normal);
    normals[t] = size > 0.0 ? (1.0 / size) * normal : Vector3{};
  }
  return normals;
}

// Of the middles of a place: the products of two components of the normals above them, summed by
// area, and their own mean.
struct Place {
  std::array<double, 6> sums{};  // xx, yy, zz, xy, yz, zx
  Vector3 middles{};
  double area = 0.0;

  void add(const Vector3& n, const Vector3& middle, double size) {
    const std::array<double, 6> products = {n[0] * n[0], n[1] * n[1], n[2] * n[2],
                                            n[0] * n[1], n[1] * n[2], n[2] * n[0]};
    for (std::size_t i = 0; i < 6; ++i) sums[i] += size * products[i];
    middles = middles + size * middle;
    area += size;
  }
  void add(const Place& other, double weight) {
    for (std::size_t i = 0; i < 6; ++i) sums[i] += weight * other.sums[i];
    middles = middles + weight * other.middles;
    area += weight * other.area;
  }

  Vector3 times(const Vector3& v) const {
    const auto [xx, yy, zz, xy, yz, zx] = sums;
    return {xx * v[0] + xy * v[1] + zx * v[2], xy * v[0] + yy * v[1] + yz * v[2],
            zx * v[0] + yz * v[1] + zz * v[2]};
  }

  /// In descending order (Smith 1961).
  Vector3 eigenvalues() const {
    const auto [xx, yy, zz, xy, yz, zx] = sums;
    const double mean = (xx + yy + zz) / 3.0;
    const double off = xy * xy + yz * yz + zx * zx;
    const Vector3 d = {xx - mean, yy - mean, zz - mean};
    const double p = std::sqrt((dot(d, d) + 2.0 * off) / 6.0);
    if (!(p > 1e-12 * mean)) return {mean, mean, mean};
    const double det =
        (d[0] * (d[1] * d[2] - yz * yz) - xy * (xy * d[2] - yz * zx) + zx * (xy * yz - d[1] * zx)) /
        (p * p * p);
    const double angle = elementary::acos(std::clamp(det / 2.0, -1.0, 1.0)) / 3.0;
    constexpr double kThird = 2.0943951023931953;  // of a turn
    const double first = mean + 2.0 * p * elementary::cos(angle);
    const double last = mean + 2.0 * p * elementary::cos(angle + kThird);
    return {first, 3.0 * mean - first - last, last};
  }
};

struct Candidate {
  std::array<Vector3, 3> corners;
  Vector3 normal;
  InnerBall ball;
  std::uint32_t triangle;
  double share;  // of the area that it stands for, its own being 1

  Vector3 middle() const { return triangle_middle(corners) - ball.radius * normal; }
};

// How much of a place is a rod, by the eigenvalues of its normals.
double rod_of(const Vector3& values) { return std::clamp(2.0 * values[1] / values[0], 0.0, 1.0); }

// How much thicker than a plate it has to be.
double extra_of(const Vector3& values) {
  const double speck = std::clamp(2.0 * values[2] / values[0], 0.0, 1.0);
  return kRod * rod_of(values) + kSpeck * speck;
}

// Whether points of the surface bound the solid, and are not within another part.
struct OuterSides {
  const std::function<float(const Vector3&)>& occupancy;
  const WindingNumbers& winding;

  // Where a gap is narrower than kClear it is filled, whichever of its sides is moved.
  bool may_be(const Vector3& point, const Vector3& normal) const {
    return occupancy(point + kClear * normal) < 1.0F;
  }
  bool is_outer(const Vector3& point, const Vector3& normal) const {
    const float beyond = occupancy(point + kClear * normal);
    if (beyond <= 0.0F || beyond >= 1.0F) return beyond <= 0.0F;
    const Vector3 start = point + kJustOutside * normal;
    for (const double far : kFarther) {
      const Vector3 end = point + far * normal;
      const float there = occupancy(end);
      if (there > 0.0F && there < 1.0F) continue;
      const std::optional<double> excess = winding.excess(start, end);
      if (!excess) continue;
      if (there <= 0.0F) return *excess <= 0.5;
      // What is full is within one part, or several.
      if (*excess >= 0.0) return false;
    }
    return winding.at(start, kFarRadii) <= 0.5;
  }
};

std::vector<Candidate> find_candidates(const MeshView<std::int32_t>& mesh,
                                       std::span<const Vector3> normals,
                                       const Representatives& chosen, const OpposedBricks& bricks,
                                       const InnerBalls& balls, const OuterSides& outer,
                                       double largest, const Progress& progress, int threads) {
  const auto rows = static_cast<std::int64_t>(chosen.triangles.size());
  std::vector<std::vector<Candidate>> tasks(
      static_cast<std::size_t>(range_count(rows, kTrianglesPerTask)));
  parallel_ranges(
      rows, kTrianglesPerTask, threads, progress, [&](std::int64_t begin, std::int64_t end) {
        std::vector<Candidate>& found = tasks[static_cast<std::size_t>(begin / kTrianglesPerTask)];
        const auto may_meet = [&](const auto& corners) { return bricks.may_meet(corners); };
        InnerBalls::Across across;
        for (std::int64_t i = begin; i < end; ++i) {
          const std::uint32_t t = chosen.triangles[static_cast<std::size_t>(i)];
          const Vector3& normal = normals[t];
          const auto may_count = [&](const Vector3& point) {
            return bricks.holds(point) && outer.may_be(point, normal);
          };
          const auto add = [&](const std::array<Vector3, 3>& piece) {
            const Vector3 middle = triangle_middle(piece);
            if (!may_count(middle)) return;
            if (!outer.is_outer(middle, normal)) return;
            const std::optional<InnerBall> ball = balls.at(middle, normal, largest, across);
            if (!ball) return;
            found.push_back({piece, normal, *ball, t, chosen.shares[static_cast<std::size_t>(i)]});
          };
          const auto add_large = [&](const std::array<Vector3, 3>& piece) {
            bool counts = may_count(triangle_middle(piece));
            if (!counts && !is_small(piece)) {
              for_pieces(piece, kPiece, may_meet, [&](const auto& small) {
                counts = counts || may_count(triangle_middle(small));
              });
            }
            if (!counts) return;
            if (bricks.is_crowded(triangle_middle(piece))) {
              found.push_back(
                  {piece, normal, {0.0, -1.0}, t, chosen.shares[static_cast<std::size_t>(i)]});
              return;
            }
            balls.find_across(piece, normal, largest, &across);
            if (across.is_empty()) return;
            if (is_small(piece)) {
              add(piece);
              return;
            }
            if (balls.are_alike(piece, normal, largest, across)) {
              const std::size_t before = found.size();
              add(piece);
              if (found.size() > before) return;
            }
            for_pieces(piece, kPiece, may_meet, add);
          };
          for_pieces(mesh.corners(t), kLargestPiece, may_meet, add_large);
        }
      });
  std::vector<Candidate> all;
  for (const std::vector<Candidate>& found : tasks)
    all.insert(all.end(), found.begin(), found.end());
  return all;
}

// What is within about a cell.
Place place_around(const std::unordered_map<std::uint64_t, Place>& places, const Vector3& middle) {
  constexpr double kReach = 1.5;
  Place around;
  const Vector3 low = {std::floor(middle[0]), std::floor(middle[1]), std::floor(middle[2])};
  for (int i = 0; i < 27; ++i) {
    const Vector3 at = {low[0] + i % 3 - 0.5, low[1] + i / 3 % 3 - 0.5, low[2] + i / 9 - 0.5};
    const auto found = places.find(cube_key(at, 1.0));
    if (found == places.end()) continue;
    double weight = 1.0;
    for (std::size_t a = 0; a < 3; ++a) weight *= kReach - std::abs(at[a] - middle[a]);
    if (weight > 0.0) around.add(found->second, weight);
  }
  return around;
}

}  // namespace

ThickPieces thick_pieces(const MeshView<std::int32_t>& mesh, double thickness, const Box& bounds,
                         const std::function<float(const Vector3&)>& occupancy,
                         const Progress& progress, int threads) {
  const double plate = thickness / 2.0;
  const double largest = plate * (1.0 + kRod + kSpeck);
  const std::vector<Vector3> normals = normals_of(mesh);
  const OpposedBricks bricks(mesh, normals, std::max(kLeastBrick, 2.0 * largest), bounds,
                             progress.part(0.0, 0.2), threads);
  ThickPieces result;
  if (bricks.is_empty()) return result;
  std::vector<std::uint32_t> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (dot(normals[t], normals[t]) > 0.0 && bricks.may_meet(mesh.corners(t))) {
      triangles.push_back(static_cast<std::uint32_t>(t));
    }
  }
  Representatives chosen = find_representatives(mesh, normals, triangles);
  const InnerBalls balls(mesh, normals, chosen.triangles, progress.part(0.2, 0.4), threads);
  const WindingNumbers winding({mesh.positions, mesh.triangles}, progress.part(0.4, 0.5), threads);
  const std::vector<Candidate> candidates =
      find_candidates(mesh, normals, chosen, bricks, balls, {occupancy, winding}, largest,
                      progress.part(0.5, 0.95), threads);
  std::unordered_map<std::uint64_t, Place> places;
  for (const Candidate& one : candidates) {
    const auto add = [&](const std::array<Vector3, 3>& piece) {
      const Vector3 middle = triangle_middle(piece) - one.ball.radius * one.normal;
      places[cube_key(middle, 1.0)].add(one.normal, middle, one.share * triangle_area(piece));
    };
    for_pieces(
        one.corners, kPiece, [](const auto&) { return true; }, add);
  }
  for (const Candidate& one : candidates) {
    const Vector3 middle = one.middle();
    const Place around = place_around(places, middle);
    const Vector3 values = around.eigenvalues();
    const double wanted = plate * (1.0 + extra_of(values));
    const double share = std::clamp((kAcross - one.ball.facing) / (kAcross - kOpposite), 0.0, 1.0);
    const double radius = one.ball.radius + share * (wanted - one.ball.radius);
    if (!(radius > one.ball.radius)) continue;
    // The middle of a plate is as wide as its faces, that of a rod a line, that of a speck a point.
    const auto across = [&](const Vector3& v) { return (1.0 / values[0]) * around.times(v); };
    const Vector3 mean = (1.0 / around.area) * around.middles;
    const Vector3 moved = middle + rod_of(values) * across(mean - middle);
    const Vector3 from = triangle_middle(one.corners);
    ThickPiece piece = {
        {}, radius, one.triangle, 2.0 * one.ball.radius, triangle_area(one.corners)};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 offset = one.corners[i] - from;
      piece.middles[i] = moved + offset - across(offset);
    }
    result.pieces.push_back(piece);
  }
  result.others = std::move(chosen.others);
  progress.report(1.0);
  return result;
}

}  // namespace prefilter
