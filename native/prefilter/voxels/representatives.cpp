// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/representatives.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <unordered_map>
#include <utility>

#include "prefilter/geometry/spatial/triangle_pieces.h"
#include "prefilter/voxels/cube_keys.h"
#include "prefilter/voxels/opposed_bricks.h"

namespace prefilter {
namespace {

constexpr double kSmallSide = 0.25;    // cells; the side below which triangles are merged
constexpr double kMaxPieceSide = 1.0;  // cells; the longest side of a piece of a narrow triangle

struct RepresentativeKey {
  std::uint64_t cube;
  int direction;

  bool operator==(const RepresentativeKey& other) const = default;
};

struct RepresentativeKeyHash {
  std::size_t operator()(const RepresentativeKey& place) const {
    const std::uint64_t mixed =
        place.cube * 0x9E3779B97F4A7C15U + static_cast<std::uint64_t>(place.direction);
    return static_cast<std::size_t>((mixed ^ (mixed >> 29U)) * 0xBF58476D1CE4E5B9U);
  }
};

using Piece = std::array<Vector3, 3>;

Vector3 longest_side(const Piece& p) {
  const std::array<Vector3, 3> sides = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  return *std::max_element(sides.begin(), sides.end(), [](const Vector3& a, const Vector3& b) {
    return dot(a, a) < dot(b, b);
  });
}

bool is_small(const Piece& p) { return length(longest_side(p)) <= kSmallSide; }

// Whether a triangle is no wider than small ones, and longer than a piece.
bool is_narrow(const Piece& p) {
  const double longest = length(longest_side(p));
  return longest > kMaxPieceSide && 2.0 * triangle_area(p) <= kSmallSide * longest;
}

// Bin of an undirected axis.
int axis_of(Vector3 side) {
  for (const double x : side) {
    if (x == 0.0) continue;
    if (x < 0.0) side = -1.0 * side;
    break;
  }
  return std::countr_zero(direction_bit(side));
}

// Pieces of narrow triangles that represent other triangles.
class NarrowPieces {
 public:
  NarrowPieces(const MeshView<std::int32_t>& mesh, std::span<const Vector3> normals,
               const std::function<bool(const Piece&)>& is_needed)
      : mesh_(mesh), normals_(normals), is_needed_(is_needed) {}

  void add(std::uint32_t t, Representatives* found, std::vector<double>* areas) {
    const Piece corners = mesh_.corners(t);
    const int direction =
        std::countr_zero(direction_bit(normals_[t])) + kDirections * axis_of(longest_side(corners));
    const std::size_t before = found->others.size();
    for_pieces(corners, kMaxPieceSide, is_needed_, [&](const Piece& piece) {
      const RepresentativeKey place = {cube_key(triangle_middle(piece), kSmallSide), direction};
      const auto [same, is_new] = known_.try_emplace(place, found->triangles.size());
      const double area = triangle_area(piece);
      if (is_new) {
        found->triangles.push_back(t);
        found->pieces.push_back(piece);
        found->are_sheets.push_back(false);
        areas->push_back(area);
        return;
      }
      (*areas)[same->second] += area;
      const std::uint32_t representative = found->triangles[same->second];
      if (representative != t) found->others.push_back({t, representative, area, false});
    });
    merge(before, &found->others);
  }

 private:
  static constexpr int kDirections = 64;  // upper limit of direction bins

  // Keeps one entry per representative among entries [begin, end).
  static void merge(std::size_t begin, std::vector<Represented>* others) {
    const auto first = others->begin() + static_cast<std::ptrdiff_t>(begin);
    std::stable_sort(first, others->end(), [](const Represented& a, const Represented& b) {
      return a.representative < b.representative;
    });
    std::size_t count = begin;
    for (std::size_t i = begin; i < others->size(); ++i) {
      const Represented one = (*others)[i];
      if (count > begin && (*others)[count - 1].representative == one.representative) {
        (*others)[count - 1].area += one.area;
      } else {
        (*others)[count++] = one;
      }
    }
    others->resize(count);
  }

  const MeshView<std::int32_t>& mesh_;
  std::span<const Vector3> normals_;
  const std::function<bool(const Piece&)>& is_needed_;
  std::unordered_map<RepresentativeKey, std::size_t, RepresentativeKeyHash> known_;
};

struct CornersHash {
  std::size_t operator()(const std::array<std::int32_t, 3>& corners) const {
    std::uint64_t mixed = 0;
    for (const std::int32_t corner : corners) {
      mixed = (mixed ^ static_cast<std::uint32_t>(corner)) * 0x9E3779B97F4A7C15U;
      mixed ^= mixed >> 29U;
    }
    return static_cast<std::size_t>(mixed);
  }
};

// The first of the triangles with the same corners.
struct FirstTriangle {
  std::size_t row;
  bool is_even;
  bool is_sheet = false;
};

// The large triangles by their sorted corners.
class FirstTriangles {
 public:
  void add(const std::array<std::int32_t, 3>& triangle, std::size_t row) {
    const auto [corners, is_even] = sorted(triangle);
    const auto [front, is_new] = fronts_.try_emplace(corners, FirstTriangle{row, is_even});
    if (!is_new && front->second.is_even != is_even) front->second.is_sheet = true;
  }
  const FirstTriangle& of(const std::array<std::int32_t, 3>& triangle) const {
    return fronts_.at(sorted(triangle).first);
  }

 private:
  static std::pair<std::array<std::int32_t, 3>, bool> sorted(
      const std::array<std::int32_t, 3>& triangle) {
    auto [a, b, c] = triangle;
    bool is_even = true;
    const auto order = [&](std::int32_t* low, std::int32_t* high) {
      if (*low <= *high) return;
      std::swap(*low, *high);
      is_even = !is_even;
    };
    order(&a, &b);
    order(&b, &c);
    order(&a, &b);
    return {{a, b, c}, is_even};
  }

  std::unordered_map<std::array<std::int32_t, 3>, FirstTriangle, CornersHash> fronts_;
};

}  // namespace

Representatives find_representatives(const MeshView<std::int32_t>& mesh,
                                     std::span<const Vector3> normals,
                                     std::span<const std::uint32_t> triangles,
                                     const std::function<bool(const Piece&)>& is_needed) {
  Representatives found;
  std::unordered_map<RepresentativeKey, std::size_t, RepresentativeKeyHash> known;
  std::vector<double> areas;
  FirstTriangles fronts;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!is_small(mesh.corners(triangles[i]))) fronts.add(mesh.triangles[triangles[i]], i);
  }
  std::vector<std::size_t> rows(triangles.size());
  std::vector<std::uint32_t> narrow;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t t = triangles[i];
    const auto corners = mesh.corners(t);
    const double area = triangle_area(corners);
    bool is_sheet = false;
    if (is_small(corners)) {
      const RepresentativeKey place = {cube_key(triangle_middle(corners), kSmallSide),
                                       std::countr_zero(direction_bit(normals[t]))};
      const auto [same, is_new] = known.try_emplace(place, found.triangles.size());
      if (!is_new) {
        found.others.push_back({t, found.triangles[same->second], area, false});
        areas[same->second] += area;
        continue;
      }
    } else {
      const FirstTriangle& front = fronts.of(mesh.triangles[t]);
      is_sheet = front.is_sheet;
      if (is_sheet && front.row != i) {
        found.others.push_back({t, triangles[front.row], area, true});
        areas[rows[front.row]] += area;
        continue;
      }
      if (!is_sheet && is_narrow(corners)) {
        narrow.push_back(t);
        continue;
      }
    }
    rows[i] = found.triangles.size();
    found.triangles.push_back(t);
    found.are_sheets.push_back(is_sheet);
    areas.push_back(area);
  }
  NarrowPieces pieces(mesh, normals, is_needed);
  for (const std::uint32_t t : narrow) pieces.add(t, &found, &areas);
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double own = triangle_area(found.corners(mesh, i));
    found.shares.push_back(own > 0.0 ? areas[i] / own : 1.0);
  }
  return found;
}

}  // namespace prefilter
