// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/thicken.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "prefilter/geometry/spatial/triangle_point.h"
#include "prefilter/voxels/combine.h"
#include "prefilter/voxels/pinholes.h"
#include "prefilter/voxels/slits.h"
#include "prefilter/voxels/thin_places.h"
#include "prefilter/wavelet/leaf_surface.h"
#include "prefilter/wavelet/tree_builder.h"

namespace prefilter {
namespace {

constexpr int kPerAxis = 2;  // samples along an axis of a cell
constexpr int kAllSamples = kPerAxis * kPerAxis * kPerAxis;
constexpr double kSampleSide = 1.0 / kPerAxis;
constexpr double kHalfDiagonal = 0.8660254037844386;
constexpr double kRounding = 1e-6;  // in cells
// Gap at a sample from which everything around the sample is inside the piece, whichever way it
// faces.
constexpr double kSettled = -kSampleSide * kHalfDiagonal - kRounding;
// Distance of a sample from the center of its cell, and of a cell twice as large.
constexpr double kToSample = (1.0 - kSampleSide) * kHalfDiagonal + kRounding;
constexpr double kFromAbove = kToSample + kHalfDiagonal;
// minimum area of a piece for its plane to be used, in squared cells
constexpr double kLeastArea = 1e-3;
constexpr float kLeastAdded = 0.02F;
constexpr double kUsualThickness = 1.5;
constexpr double kThinnestOfWalls = 0.1;  // ignored share of each triangle's area
constexpr double kMargin = 4.0;           // around the root, for pieces that may reach into it

struct PieceCell {
  struct Near {
    double gap;  // gap to the center of the second finest cell; 0 at smaller depths
    std::uint32_t piece;
    bool operator<(const Near& other) const {
      return gap != other.gap ? gap < other.gap : piece < other.piece;
    }
  };
  LeafPlace at;  // in cells of its depth
  std::vector<Near> pieces;
};

// Builds the tree of cells inside the pieces; coordinates are in finest cells.
class PieceRule {
 public:
  PieceRule(const std::vector<ThickPiece>& pieces, const Octree& octree)
      : pieces_(pieces), octree_(octree) {
    boxes_.reserve(pieces.size());
    for (const ThickPiece& piece : pieces) {
      Box box = kEmptyBox;
      for (const Vector3& p : piece.middles) box.include(p);
      for (int a = 0; a < 3; ++a) {
        box.low[a] -= piece.radius;
        box.high[a] += piece.radius;
      }
      boxes_.push_back(box);
      const auto& [a, b, c] = piece.middles;
      const Vector3 normal = cross(b - a, c - a);
      const double size = length(normal);
      Plane plane = {{0.0, 0.0, 0.0}, 0.0, piece.radius + kRounding};
      if (size > kLeastArea) {
        plane.normal = (1.0 / size) * normal;
        plane.offset = dot(plane.normal, a);
      }
      planes_.push_back(plane);
    }
  }

  PieceCell root() const {
    PieceCell cell{{0, 0, 0}, {}};
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) cell.pieces.push_back({0.0, i});
    return cell;
  }

  bool is_split(const PieceCell& cell, int depth) const {
    return depth < octree_.depth && !cell.pieces.empty() && !is_full(cell, depth);
  }

  PieceCell octant(const PieceCell& cell, int depth, int o) const {
    PieceCell result;
    const double side = std::ldexp(1.0, octree_.depth - depth - 1);
    Box box;
    for (int a = 0; a < 3; ++a) {
      result.at[a] = 2 * cell.at[a] + ((o >> a) & 1);
      box.low[a] = result.at[a] * side;
      box.high[a] = box.low[a] + side;
    }
    const Vector3 center = 0.5 * (box.low + box.high);
    for (const PieceCell::Near& near : cell.pieces) {
      if (!boxes_[near.piece].overlaps(box)) continue;
      // Large pieces are far from most of their box.
      if (least_gap(near.piece, center) > side * kHalfDiagonal) continue;
      result.pieces.push_back(near);
    }
    if (depth + 2 == octree_.depth) put_near_first(&result);
    return result;
  }

  // Occupancy of a cell by the pieces, if it exceeds the present one.
  float value(const PieceCell& cell, int depth) const {
    if (cell.pieces.empty()) return 0.0F;
    if (depth < octree_.depth) return 1.0F;
    const float before = occupancy_at(octree_.cells, octree_.depth, cell.at);
    if (before >= 1.0F) return 0.0F;
    std::array<Gap, kAllSamples> least;
    if (!find_least(cell, &least)) return 0.0F;
    double sum = 0.0;
    for (const Gap& one : least) {
      const double width =
          kSampleSide * (std::abs(one.away[0]) + std::abs(one.away[1]) + std::abs(one.away[2]));
      sum += std::clamp(0.5 - one.size / width, 0.0, 1.0);
    }
    const auto share = static_cast<float>(sum * kSampleSide * kSampleSide * kSampleSide);
    return share > before + kLeastAdded ? share : 0.0F;
  }

 private:
  // Whether a cell is inside one of the pieces.
  bool is_full(const PieceCell& cell, int depth) const {
    const double side = std::ldexp(1.0, octree_.depth - depth);
    const Vector3 center = {(cell.at[0] + 0.5) * side, (cell.at[1] + 0.5) * side,
                            (cell.at[2] + 0.5) * side};
    return std::any_of(cell.pieces.begin(), cell.pieces.end(), [&](const PieceCell::Near& near) {
      return pieces_[near.piece].radius > side * kHalfDiagonal &&
             gap(pieces_[near.piece], center).size < -side * kHalfDiagonal;
    });
  }

  // Sorts the pieces that reach a second finest cell by distance, as the nearest few decide it.
  void put_near_first(PieceCell* cell) const {
    const Vector3 center = {2.0 * cell->at[0] + 1.0, 2.0 * cell->at[1] + 1.0,
                            2.0 * cell->at[2] + 1.0};
    for (PieceCell::Near& near : cell->pieces) near.gap = gap(pieces_[near.piece], center).size;
    std::erase_if(cell->pieces,
                  [](const PieceCell::Near& near) { return near.gap >= 2.0 * kHalfDiagonal; });
    std::sort(cell->pieces.begin(), cell->pieces.end());
  }

  // Lower bound on the gap between a piece and a point, from the piece's plane.
  double least_gap(std::uint32_t piece, const Vector3& point) const {
    const Plane& plane = planes_[piece];
    return std::abs(dot(plane.normal, point) - plane.offset) - plane.reach;
  }

  // Signed distance from a piece to a point, negative inside.
  struct Gap {
    double size;
    Vector3 away;
  };

  static Gap gap(const ThickPiece& piece, const Vector3& point) {
    const auto& [a, b, c] = piece.middles;
    const Vector3 w = nearest_weights(point, a, b, c);
    const Vector3 d = point - (w[0] * a + w[1] * b + w[2] * c);
    const double distance = std::sqrt(dot(d, d));
    if (!(distance > 0.0)) return {-piece.radius, {1.0, 0.0, 0.0}};
    return {distance - piece.radius, (1.0 / distance) * d};
  }

  // For each sample of a cell, finds the least gap to a piece, or one that suffices. Returns
  // whether any piece reaches the cell.
  bool find_least(const PieceCell& cell, std::array<Gap, kAllSamples>* least) const {
    std::array<Vector3, kAllSamples> points;
    for (int i = 0; i < kAllSamples; ++i) {
      const std::array<int, 3> k = {i % kPerAxis, i / kPerAxis % kPerAxis, i / kPerAxis / kPerAxis};
      for (std::size_t a = 0; a < 3; ++a) points[i][a] = cell.at[a] + (k[a] + 0.5) * kSampleSide;
    }
    least->fill({kHalfDiagonal * 2.0, {1.0, 0.0, 0.0}});
    const Vector3 center = {cell.at[0] + 0.5, cell.at[1] + 0.5, cell.at[2] + 0.5};
    bool is_reached = false;
    double most = least->front().size;
    for (const PieceCell::Near& near : cell.pieces) {
      // The gap changes by at most the distance moved, so no later piece has a smaller one.
      if (near.gap - kFromAbove >= most) break;
      if (least_gap(near.piece, center) - kToSample >= most) continue;
      const ThickPiece& piece = pieces_[near.piece];
      const double middle = gap(piece, center).size;
      if (middle >= kHalfDiagonal) continue;
      is_reached = true;
      most = kSettled;
      for (std::size_t k = 0; k < kAllSamples; ++k) {
        Gap& best = (*least)[k];
        if (best.size > kSettled && middle - kToSample < best.size) {
          const Gap one = gap(piece, points[k]);
          if (one.size < best.size) best = one;
        }
        most = std::max(most, best.size);
      }
      if (most <= kSettled) break;
    }
    return is_reached;
  }

  const std::vector<ThickPiece>& pieces_;
  const Octree& octree_;
  std::vector<Box> boxes_;
  struct Plane {
    Vector3 normal;  // zero for pieces without area
    double offset;
    double reach;
  };
  std::vector<Plane> planes_;
};

// The mesh in units of 1 / count of the root's side, without triangles that are very far away.
TriangleMesh in_units(const RootTriangles& mesh, double count) {
  constexpr double kFarthest = 1e9;  // units
  TriangleMesh result;
  result.positions.reserve(mesh.mesh.positions.size());
  std::vector<bool> is_far(mesh.mesh.positions.size(), false);
  for (const Vector3& p : mesh.mesh.positions) {
    Vector3 q;
    for (int a = 0; a < 3; ++a) {
      q[a] = (p[a] - mesh.root.low[a]) / mesh.root.size(a) * count;
      if (std::abs(q[a]) <= kFarthest) continue;
      is_far[result.positions.size()] = true;
      q[a] = 0.0;
    }
    result.positions.push_back(q);
  }
  result.triangles.reserve(mesh.mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.mesh.triangles) {
    const bool is_left_out = is_far[static_cast<std::size_t>(a)] ||
                             is_far[static_cast<std::size_t>(b)] ||
                             is_far[static_cast<std::size_t>(c)];
    // Degenerate triangles keep the indices of the others.
    result.triangles.push_back({static_cast<std::int32_t>(a),
                                static_cast<std::int32_t>(is_left_out ? a : b),
                                static_cast<std::int32_t>(is_left_out ? a : c)});
  }
  return result;
}

// Unit in cells, chosen so that the thickness is at most kUsualThickness, which limits the number
// of pieces.
double thickness_unit(double thickness) { return std::max(1.0, thickness / kUsualThickness); }

// Pieces to add to the octree, in cells of its depth.
ThickPieces pieces_for(const RootTriangles& mesh, double thickness, const Octree& octree,
                       const Run& run) {
  const double unit = thickness_unit(thickness);
  const double count = std::ldexp(1.0, octree.depth) / unit;
  const TriangleMesh scaled = in_units(mesh, count);
  const auto occupancy = [&](const Vector3& point) {
    LeafPlace place;
    for (std::size_t a = 0; a < 3; ++a) {
      place[a] = static_cast<int>(std::floor(std::clamp(point[a], -1.0, count) * unit));
    }
    return occupancy_at(octree.cells, octree.depth, place);
  };
  const Box bounds = {{-kMargin, -kMargin, -kMargin},
                      {count + kMargin, count + kMargin, count + kMargin}};
  ThickPieces found =
      thick_pieces({scaled.positions, scaled.triangles}, thickness / unit, bounds, occupancy, run);
  for (ThickPiece& piece : found.pieces) {
    for (Vector3& middle : piece.middles) middle = unit * middle;
    piece.radius *= unit;
    piece.thickness *= unit;
    piece.area *= unit * unit;
  }
  for (Represented& other : found.others) other.area *= unit * unit;
  return found;
}

// Sorts and merges entries per triangle: keeps the thickness that all but a share of its area
// exceeds, and the total area.
void merge(double share, std::vector<ThinTriangle>* all) {
  std::stable_sort(all->begin(), all->end(), [](const ThinTriangle& a, const ThinTriangle& b) {
    return a.triangle != b.triangle ? a.triangle < b.triangle : a.thickness < b.thickness;
  });
  std::size_t count = 0;
  for (std::size_t i = 0; i < all->size();) {
    std::size_t end = i;
    double area = 0.0;
    for (; end < all->size() && (*all)[end].triangle == (*all)[i].triangle; ++end) {
      area += (*all)[end].area;
    }
    std::size_t chosen = i;
    for (double thinner = 0.0; chosen + 1 < end; ++chosen) {
      thinner += (*all)[chosen].area;
      if (thinner > share * area) break;
    }
    ThinTriangle one = (*all)[chosen];
    one.area = area;
    (*all)[count++] = one;
    i = end;
  }
  all->resize(count);
}

// Thin triangles, or thin walls only, with the thickness that all but a share of the area exceeds.
std::vector<ThinTriangle> thin_triangles(const ThickPieces& found, bool only_walls, double share) {
  std::vector<ThinTriangle> all;
  for (const ThickPiece& piece : found.pieces) {
    if (only_walls && !piece.is_wall) continue;
    all.push_back({piece.triangle, piece.thickness, 2.0 * piece.radius, piece.area});
  }
  merge(share, &all);
  const auto count = static_cast<std::ptrdiff_t>(all.size());
  for (const Represented& other : found.others) {
    const auto known = all.begin() + count;
    const auto same = std::lower_bound(
        all.begin(), known, other.representative,
        [](const ThinTriangle& one, std::uint32_t triangle) { return one.triangle < triangle; });
    if (same == known || same->triangle != other.representative) continue;
    ThinTriangle one = *same;
    one.triangle = other.triangle;
    if (!other.is_back) one.area = other.area;
    all.push_back(one);
  }
  merge(share, &all);
  return all;
}

}  // namespace

void thicken(const RootTriangles& mesh, double thickness, const Run& run, Octree* octree) {
  const Stages stages(run, {60, 30, 7, 1, 2});
  const ThickPieces found = pieces_for(mesh, thickness, *octree, stages[0]);
  CellTree thickened;
  if (!found.pieces.empty()) {
    const PieceRule rule(found.pieces, *octree);
    Octree added;
    added.bounds = octree->bounds;
    added.depth = octree->depth;
    added.cells = build_tree(rule.root(), octree->depth, rule, stages[1]);
    *octree = combine(*octree, added, SetOperation::kUnion, stages[2]);
    thickened = std::move(added.cells);
    fill_pinholes(thickened, octree->depth, stages[3], &octree->cells);
  }
  if (found.winding) {
    open_slits(*found.winding, thickness_unit(thickness), thickened, octree->depth, stages[4],
               &octree->cells);
  }
  if (!found.pieces.empty()) {
    octree->thickened = std::move(thickened);
    octree->thin = thin_triangles(found, false, 0.0);
    octree->thin_walls = thin_triangles(found, true, kThinnestOfWalls);
  }
  run.report(1.0);
}

}  // namespace prefilter
