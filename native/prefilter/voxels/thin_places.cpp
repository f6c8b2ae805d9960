// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/thin_places.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/geometry/spatial/triangle_pieces.h"
#include "prefilter/voxels/cube_keys.h"
#include "prefilter/voxels/cube_table.h"
#include "prefilter/voxels/inner_balls.h"
#include "prefilter/voxels/opposed_bricks.h"
#include "prefilter/voxels/outer_sides.h"

namespace prefilter {
namespace {

constexpr double kLongestPiece = 1.0;  // longest side of a piece, in cells
constexpr double kLargestPiece = 4.0;  // the same for a piece that is equally thin everywhere
constexpr double kLeastBrick = 2.0;    // in cells
// Cosines between normals: opposite on a rod (148 degrees), and the start and end of the range on a
// plate (150 and 160 degrees). Wider openings are wedges, whose body holds them together and whose
// edge contours can place.
constexpr double kOpposite = -0.85;
constexpr double kPlateAcross = -0.866;
constexpr double kPlateOpposite = -0.94;
constexpr double kParallel = -0.985;  // cosine between the normals of a wall: 170 degrees
// Additional thickness of rods and specks relative to plates: cells show a quarter of a rod's disk
// along a common edge, and an eighth of a speck's ball at a common corner, which must be half of a
// cell.
constexpr double kRod = 0.23;
constexpr double kSpeck = 0.17;
constexpr std::int64_t kTrianglesPerTask = 1 << 6;

bool is_short(const std::array<Vector3, 3>& p) {
  return std::max({length(p[1] - p[0]), length(p[2] - p[1]), length(p[0] - p[2])}) <= kLongestPiece;
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

// Area-weighted sums over the medial points of a place: products of normal components, and the mean
// point.
struct PlaceSums {
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
  void add(const PlaceSums& other, double weight) {
    for (std::size_t i = 0; i < 6; ++i) sums[i] += weight * other.sums[i];
    middles = middles + weight * other.middles;
    area += weight * other.area;
  }

  Vector3 times(const Vector3& v) const {
    const auto [xx, yy, zz, xy, yz, zx] = sums;
    return {xx * v[0] + xy * v[1] + zx * v[2], xy * v[0] + yy * v[1] + yz * v[2],
            zx * v[0] + yz * v[1] + zz * v[2]};
  }

  /// Eigenvalues in descending order (O. Smith, Eigenvalues of a symmetric 3 x 3 matrix, 1961).
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
    constexpr double kThird = 2.0943951023931953;  // of a full turn
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
  double share;   // represented area relative to its own
  bool is_plate;  // independent of its surroundings

  Vector3 middle() const { return triangle_middle(corners) - ball.radius * normal; }
};

// How rod-like a place is, from 0 to 1, by the eigenvalues of its normals.
double rod_of(const Vector3& values) { return std::clamp(2.0 * values[1] / values[0], 0.0, 1.0); }

// Share of the missing thickness that is added, by the cosine between opposite normals.
double thickened_share(double facing, double rod) {
  // A wedge below the limit has a value of 0.14, a rod with five sides 1.
  const double share = std::clamp((rod - 0.4) / 0.4, 0.0, 1.0);
  const double across = kPlateAcross + share * (kAcross - kPlateAcross);
  const double opposite = kPlateOpposite + share * (kOpposite - kPlateOpposite);
  const double counted = (across - facing) / (across - opposite);
  // Small additions would only destroy edges.
  return counted < 0.5 ? 0.0 : std::min(counted, 1.0);
}

// Required additional thickness relative to a plate.
double extra_of(const Vector3& values) {
  const double speck = std::clamp(2.0 * values[2] / values[0], 0.0, 1.0);
  return kRod * rod_of(values) + kSpeck * speck;
}

// Finds the thin pieces of triangles. Triangles are divided only where their parts differ, since
// the cost grows with the number of pieces per cell.
class CandidateFinder {
 public:
  CandidateFinder(const OpposedBricks& bricks, const InnerBalls& balls, const OuterSides& outer,
                  double largest, std::vector<Candidate>* found)
      : bricks_(bricks), balls_(balls), outer_(outer), largest_(largest), found_(found) {}

  /// Adds triangle number `index` of `chosen`.
  void add(const std::array<Vector3, 3>& corners, const Vector3& normal,
           const Representatives& chosen, std::size_t index) {
    normal_ = normal;
    is_sheet_ = chosen.are_sheets[index];
    triangle_ = chosen.triangles[index];
    share_ = chosen.shares[index];
    if (is_sheet_) {
      if (add_plates(corners)) push_plate(corners);
    } else {
      for_pieces(corners, kLargestPiece, may_meet_, [&](const auto& piece) { add_piece(piece); });
    }
  }

 private:
  // For sheets: returns true, without adding anything, if all of the piece is a plate; two halves
  // that are can then be one plate, as large as the triangle if all of it is in crowded bricks.
  bool add_plates(const std::array<Vector3, 3>& piece) {
    if (!bricks_.may_meet(piece)) return false;
    const auto halves = halves_of(piece, kLargestPiece);
    if (!halves) {
      const Vector3 middle = triangle_middle(piece);
      if (!is_short(piece) && bricks_.is_crowded(middle) &&
          (may_count(middle) || has_counting(piece))) {
        return true;
      }
      add_piece(piece);
      return false;
    }
    const std::array<bool, 2> are_plates = {add_plates((*halves)[0]), add_plates((*halves)[1])};
    if (are_plates[0] && are_plates[1]) return true;
    for (std::size_t i = 0; i < 2; ++i) {
      if (are_plates[i]) push_plate((*halves)[i]);
    }
    return false;
  }

  void push_plate(const std::array<Vector3, 3>& piece) {
    found_->push_back({piece, normal_, kSheet, triangle_, share_, true});
  }

  // A sheet counts if one of its faces does.
  bool may_count(const Vector3& point) const {
    return bricks_.holds(point) &&
           (outer_.may_be(point, normal_) || (is_sheet_ && outer_.may_be(point, -1.0 * normal_)));
  }

  bool is_outer(const Vector3& point) const {
    return outer_.is_outer(point, normal_) || (is_sheet_ && outer_.is_outer(point, -1.0 * normal_));
  }

  void push(const std::array<Vector3, 3>& piece, const InnerBall& ball) {
    found_->push_back({piece, normal_, ball, triangle_, share_, false});
  }

  // Adds a piece if its center is outer and thin; returns whether it did.
  bool push_outer(const std::array<Vector3, 3>& piece) {
    const Vector3 middle = triangle_middle(piece);
    if (!is_outer(middle)) return false;
    if (is_sheet_) {
      push(piece, kSheet);
      return true;
    }
    const std::optional<InnerBall> ball =
        balls_.at(middle, normal_, largest_, across_, is_across_outer_);
    if (ball) push(piece, *ball);
    return ball.has_value();
  }

  // Adds a piece no larger than kLargestPiece.
  void add_piece(const std::array<Vector3, 3>& piece) {
    const Vector3 middle = triangle_middle(piece);
    const bool counts = may_count(middle);
    if (!counts && (is_short(piece) || !has_counting(piece))) return;
    if (bricks_.is_crowded(middle)) {
      push(piece, kSheet);
      return;
    }
    if (is_short(piece)) {
      // For a single ball, a list of opposite triangles is not worthwhile.
      across_.has_more = true;
      push_outer(piece);
      return;
    }
    if (!is_sheet_) {
      balls_.find_across(piece, normal_, largest_, &across_);
      if (across_.is_empty()) return;
    }
    // Add the whole piece if it is equally thin everywhere.
    if (counts && (is_sheet_ || balls_.are_alike(piece, normal_, largest_, across_)) &&
        push_outer(piece)) {
      return;
    }
    for_pieces(piece, kLongestPiece, may_meet_, [&](const auto& small) {
      if (may_count(triangle_middle(small))) push_outer(small);
    });
  }

  // Whether any part of the piece may count, although its center does not.
  bool has_counting(const std::array<Vector3, 3>& piece) const {
    bool counts = false;
    for_pieces(piece, kLongestPiece, may_meet_,
               [&](const auto& small) { counts = counts || may_count(triangle_middle(small)); });
    return counts;
  }

  static constexpr InnerBall kSheet = {0.0, -1.0, -1.0};  // for surfaces without an inside

  struct MayMeet {
    const OpposedBricks& bricks;
    bool operator()(const std::array<Vector3, 3>& corners) const {
      return bricks.may_meet(corners);
    }
  };

  const OpposedBricks& bricks_;
  MayMeet may_meet_{bricks_};
  const InnerBalls& balls_;
  const OuterSides& outer_;
  InnerBalls::IsOuter is_across_outer_ = [this](const Vector3& point, const Vector3& normal) {
    return outer_.is_outer(point, normal) || outer_.is_outer(point, -1.0 * normal);
  };
  double largest_;
  std::vector<Candidate>* found_;
  InnerBalls::Across across_;
  // State of the current triangle.
  Vector3 normal_{};
  bool is_sheet_ = false;
  std::uint32_t triangle_ = 0;
  double share_ = 1.0;
};

std::vector<Candidate> find_candidates(const MeshView<std::int32_t>& mesh,
                                       std::span<const Vector3> normals,
                                       const Representatives& chosen, const OpposedBricks& bricks,
                                       const InnerBalls& balls, const OuterSides& outer,
                                       double largest, const Run& run) {
  const auto rows = static_cast<std::int64_t>(chosen.triangles.size());
  std::vector<std::vector<Candidate>> tasks(
      static_cast<std::size_t>(range_count(rows, kTrianglesPerTask)));
  parallel_ranges(rows, kTrianglesPerTask, run, [&](std::int64_t begin, std::int64_t end) {
    CandidateFinder finder(bricks, balls, outer, largest,
                           &tasks[static_cast<std::size_t>(begin / kTrianglesPerTask)]);
    for (std::int64_t i = begin; i < end; ++i) {
      const std::uint32_t t = chosen.triangles[static_cast<std::size_t>(i)];
      finder.add(chosen.corners(mesh, static_cast<std::size_t>(i)), normals[t], chosen,
                 static_cast<std::size_t>(i));
    }
  });
  std::vector<Candidate> all;
  for (const std::vector<Candidate>& found : tasks)
    all.insert(all.end(), found.begin(), found.end());
  return all;
}

// Weighted sums within about a cell.
PlaceSums place_around(const CubeTable<PlaceSums>& places, const Vector3& middle) {
  constexpr double kReach = 1.5;  // cells: the weight falls to 0 there
  PlaceSums around;
  const Vector3 low = {std::floor(middle[0]), std::floor(middle[1]), std::floor(middle[2])};
  const std::uint64_t first = cube_key(low - Vector3{0.5, 0.5, 0.5}, 1.0);
  for (std::uint64_t i = 0; i < 27; ++i) {
    const std::array<std::uint64_t, 3> k = {i % 3, i / 3 % 3, i / 9};
    const PlaceSums* found = places.find(first + (k[0] << 42U) + (k[1] << 21U) + k[2]);
    if (found == nullptr) continue;
    double weight = 1.0;
    for (std::size_t a = 0; a < 3; ++a) {
      weight *= kReach - std::abs(low[a] + static_cast<double>(k[a]) - 0.5 - middle[a]);
    }
    if (weight > 0.0) around.add(*found, weight);
  }
  return around;
}

}  // namespace

ThickPieces thick_pieces(const MeshView<std::int32_t>& mesh, double thickness, const Box& bounds,
                         const std::function<float(const Vector3&)>& occupancy, const Run& run) {
  const double plate = thickness / 2.0;
  const double largest = plate * (1.0 + kRod + kSpeck);
  const std::vector<Vector3> normals = normals_of(mesh);
  const OpposedBricks bricks(mesh, normals, std::max(kLeastBrick, 2.0 * largest), bounds,
                             run.part(0.0, 0.2));
  ThickPieces result;
  if (bricks.is_empty()) return result;
  std::vector<std::uint32_t> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (dot(normals[t], normals[t]) > 0.0 && bricks.may_meet(mesh.corners(t))) {
      triangles.push_back(static_cast<std::uint32_t>(t));
    }
  }
  Representatives chosen = find_representatives(
      mesh, normals, triangles, [&](const auto& corners) { return bricks.may_meet(corners); });
  // Balls touch both faces of sheets, so backs are included.
  std::vector<std::uint32_t> facing = chosen.triangles;
  facing.erase(std::unique(facing.begin(), facing.end()), facing.end());
  for (const Represented& other : chosen.others) {
    if (other.is_back) facing.push_back(other.triangle);
  }
  const InnerBalls balls(mesh, normals, facing, run.part(0.2, 0.4));
  result.winding = std::make_unique<const WindingNumbers>(InputMesh{mesh.positions, mesh.triangles},
                                                          run.part(0.4, 0.5));
  const OuterSides outer(occupancy, *result.winding);
  const std::vector<Candidate> candidates =
      find_candidates(mesh, normals, chosen, bricks, balls, outer, largest, run.part(0.5, 0.95));
  CubeTable<PlaceSums> places;
  for (const Candidate& one : candidates) {
    if (one.is_plate) continue;
    const auto add = [&](const std::array<Vector3, 3>& piece) {
      const Vector3 middle = triangle_middle(piece) - one.ball.radius * one.normal;
      places[cube_key(middle, 1.0)].add(one.normal, middle, one.share * triangle_area(piece));
    };
    for_pieces(
        one.corners, kLongestPiece, [](const auto&) { return true; }, add);
  }
  for (const Candidate& one : candidates) {
    if (one.is_plate) {
      result.pieces.push_back(
          {one.corners, plate, one.triangle, 0.0, triangle_area(one.corners), true});
      continue;
    }
    const Vector3 middle = one.middle();
    const PlaceSums around = place_around(places, middle);
    const Vector3 values = around.eigenvalues();
    const double wanted = plate * (1.0 + extra_of(values));
    const double share = thickened_share(one.ball.facing, rod_of(values));
    const double radius = one.ball.radius + share * (wanted - one.ball.radius);
    if (!(radius > one.ball.radius)) continue;
    // The medial surface of a plate is as wide as its faces, that of a rod a line, of a speck a
    // point.
    const auto across = [&](const Vector3& v) { return (1.0 / values[0]) * around.times(v); };
    const Vector3 mean = (1.0 / around.area) * around.middles;
    const Vector3 moved = middle + rod_of(values) * across(mean - middle);
    const Vector3 from = triangle_middle(one.corners);
    ThickPiece piece = {{},
                        radius,
                        one.triangle,
                        2.0 * one.ball.radius,
                        triangle_area(one.corners),
                        one.ball.across < kParallel};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 offset = one.corners[i] - from;
      piece.middles[i] = moved + offset - across(offset);
    }
    result.pieces.push_back(piece);
  }
  result.others = std::move(chosen.others);
  run.report(1.0);
  return result;
}

}  // namespace prefilter
