// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/intersections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/voxels/remesh/predicates.h"

namespace prefilter {
namespace {

using Pairs = std::vector<std::array<std::uint32_t, 2>>;
using Whole = std::array<std::int64_t, 3>;

Pairs pairs_of(const TriangleMesh& mesh, int threads = 1,
               const std::vector<std::uint8_t>& is_suspect = {}) {
  return intersecting_triangles({mesh.positions, mesh.triangles}, is_suspect,
                                prefilter::Run(threads));
}

Whole minus(const Whole& a, const Whole& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Whole times(const Whole& a, const Whole& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
std::int64_t product(const Whole& a, const Whole& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Whether two convex polygons (a segment has two points) have a point in common: no axis separates
// them. Coordinates must be below 2^15, since an axis can be a product of three edges.
bool do_meet(const std::vector<Whole>& a, const std::vector<Whole>& b) {
  std::vector<Whole> a_edges;
  std::vector<Whole> b_edges;
  for (std::size_t i = 0; i < a.size(); ++i) a_edges.push_back(minus(a[(i + 1) % a.size()], a[i]));
  for (std::size_t i = 0; i < b.size(); ++i) b_edges.push_back(minus(b[(i + 1) % b.size()], b[i]));
  const Whole a_normal = times(a_edges[0], a_edges[1]);
  const Whole b_normal = times(b_edges[0], b_edges[1]);
  std::vector<Whole> axes = {a_normal, b_normal};
  for (const Whole& edge : a_edges) {
    for (const Whole& other : b_edges) axes.push_back(times(edge, other));
    axes.push_back(times(edge, a_normal));
    axes.push_back(times(edge, b_normal));
  }
  for (const Whole& edge : b_edges) {
    axes.push_back(times(edge, a_normal));
    axes.push_back(times(edge, b_normal));
  }
  return std::none_of(axes.begin(), axes.end(), [&](const Whole& axis) {
    const auto less = [&](const Whole& p, const Whole& q) {
      return product(axis, p) < product(axis, q);
    };
    const auto [a_low, a_high] = std::minmax_element(a.begin(), a.end(), less);
    const auto [b_low, b_high] = std::minmax_element(b.begin(), b.end(), less);
    return less(*a_high, *b_low) || less(*b_high, *a_low);
  });
}

struct WholeMesh {
  std::vector<Whole> points;
  std::array<std::array<std::int32_t, 3>, 2> triangles;

  bool is_flat(std::size_t t) const {
    const auto& [a, b, c] = triangles[t];
    return times(minus(point(b), point(a)), minus(point(c), point(a))) == Whole{0, 0, 0};
  }
  const Whole& point(std::int32_t vertex) const { return points[static_cast<std::size_t>(vertex)]; }

  bool does_intersect() const {
    std::vector<std::int32_t> shared;
    std::array<std::vector<Whole>, 2> all;
    std::array<std::vector<Whole>, 2> others;
    for (std::size_t t = 0; t < 2; ++t) {
      for (const std::int32_t v : triangles[t]) {
        all[t].push_back(point(v));
        const auto& other = triangles[1 - t];
        if (std::find(other.begin(), other.end(), v) == other.end()) {
          others[t].push_back(point(v));
        } else if (t == 0) {
          shared.push_back(v);
        }
      }
    }
    switch (shared.size()) {
      case 0:
        return do_meet(all[0], all[1]);
      case 1:
        return do_meet(all[0], others[1]) || do_meet(all[1], others[0]);
      case 2: {
        const Whole edge = minus(point(shared[1]), point(shared[0]));
        const Whole a = times(edge, minus(others[0][0], point(shared[0])));
        const Whole b = times(edge, minus(others[1][0], point(shared[0])));
        return times(a, b) == Whole{0, 0, 0} && product(a, b) > 0;
      }
      default:
        return true;
    }
  }
};

TEST(IntersectingTriangles, AreNotSeparatedByAnyAxis) {
  std::mt19937 random(1);
  const auto below = [&](int n) {
    return static_cast<std::int64_t>(random() % static_cast<unsigned>(n));
  };
  int hits = 0;
  constexpr int kPairs = 60000;
  for (int i = 0; i < kPairs; ++i) {
    WholeMesh mesh;
    const int size = 2 + static_cast<int>(below(6));
    const int planes = static_cast<int>(below(3));  // 0: anywhere; 1: in a plane; 2: about in one
    const Whole u = {below(9) - 4, below(9) - 4, below(9) - 4};
    const Whole v = {below(9) - 4, below(9) - 4, below(9) - 4};
    for (int k = 0; k < 6; ++k) {
      Whole point = {below(size), below(size), below(size)};
      if (planes > 0) {
        const std::int64_t s = below(size);
        const std::int64_t t = below(size);
        for (std::size_t a = 0; a < 3; ++a) {
          point[a] = 4 * (s * u[a] + t * v[a]) + (planes == 2 ? below(2) : 0);
        }
      }
      mesh.points.push_back(point);
    }
    const auto shared = static_cast<std::int32_t>(below(4));
    for (std::int32_t k = 0; k < 3; ++k) {
      mesh.triangles[0][static_cast<std::size_t>(k)] = k;
      mesh.triangles[1][static_cast<std::size_t>(k)] = k < shared ? k : 3 + k;
    }
    std::shuffle(mesh.triangles[1].begin(), mesh.triangles[1].end(), random);
    // Scales far from 1, with few enough digits that nothing is rounded.
    const double unit = std::ldexp(3.0, static_cast<int>(below(400)) - 200);
    TriangleMesh floating;
    for (const Whole& p : mesh.points) {
      floating.positions.push_back({unit * static_cast<double>(p[0]),
                                    unit * static_cast<double>(p[1]),
                                    unit * static_cast<double>(p[2])});
    }
    floating.triangles = {mesh.triangles[0], mesh.triangles[1]};
    Pairs expected;
    if (mesh.is_flat(0)) expected.push_back({0, 0});
    if (!mesh.is_flat(0) && !mesh.is_flat(1) && mesh.does_intersect()) expected.push_back({0, 1});
    if (mesh.is_flat(1)) expected.push_back({1, 1});
    ASSERT_EQ(pairs_of(floating), expected) << "pair " << i;
    hits += expected == Pairs{{0, 1}} ? 1 : 0;
  }
  EXPECT_GT(hits, kPairs / 20);
  EXPECT_LT(hits, kPairs / 2);
}

// A height field over size x size squares.
TriangleMesh sheet(int size, double height) {
  std::mt19937 random(2);
  TriangleMesh mesh;
  for (int i = 0; i <= size; ++i) {
    for (int j = 0; j <= size; ++j) {
      mesh.positions.push_back({static_cast<double>(i), static_cast<double>(j),
                                height + 0.3 * static_cast<double>(random() % 1000) / 1000.0});
    }
  }
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      const std::int32_t a = i * (size + 1) + j;
      const std::int32_t b = a + size + 1;
      mesh.triangles.push_back({a, b, a + 1});
      mesh.triangles.push_back({a + 1, b, b + 1});
    }
  }
  return mesh;
}

void append(const TriangleMesh& other, TriangleMesh* mesh) {
  const auto base = static_cast<std::int32_t>(mesh->positions.size());
  mesh->positions.insert(mesh->positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& t : other.triangles) {
    mesh->triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
}

TEST(IntersectingTriangles, OfSheetsAreWhereTheyCross) {
  TriangleMesh mesh = sheet(60, 0.0);
  EXPECT_TRUE(pairs_of(mesh).empty());
  append(sheet(60, 1.0), &mesh);
  EXPECT_TRUE(pairs_of(mesh).empty());
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  // Large triangles among small ones: one through both sheets, one through the first sheet only.
  append({{{10.2, 10.1, -5.0}, {50.3, 10.1, -5.0}, {30.2, 50.1, 9.0}}, {{0, 1, 2}}}, &mesh);
  append({{{5.5, 5.5, -5.0}, {5.5, 5.6, 0.9}, {5.6, 5.5, -5.0}}, {{0, 1, 2}}}, &mesh);
  const Pairs pairs = pairs_of(mesh);
  EXPECT_TRUE(std::all_of(pairs.begin(), pairs.end(),
                          [&](const auto& pair) { return pair[0] < count && pair[1] >= count; }));
  const auto crossed =
      std::count_if(pairs.begin(), pairs.end(), [&](const auto& pair) { return pair[1] == count; });
  EXPECT_GT(crossed, 60);
  EXPECT_TRUE(std::any_of(pairs.begin(), pairs.end(),
                          [&](const auto& pair) { return pair[1] == count + 1; }));
  EXPECT_EQ(pairs_of(mesh, 4), pairs);

  std::vector<std::uint8_t> is_suspect(mesh.triangles.size());
  EXPECT_TRUE(pairs_of(mesh, 2, is_suspect).empty());
  is_suspect[count] = 1;
  is_suspect[pairs[0][0]] = 1;
  Pairs expected;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(expected), [&](const auto& pair) {
    return is_suspect[pair[0]] != 0 || is_suspect[pair[1]] != 0;
  });
  EXPECT_EQ(pairs_of(mesh, 2, is_suspect), expected);

  for (const double scale : {1e-250, 1e-80, 1e120, 1e290}) {
    TriangleMesh scaled = mesh;
    for (Vector3& p : scaled.positions) p = {scale * p[0], scale * p[1], scale * p[2]};
    EXPECT_EQ(pairs_of(scaled), pairs) << scale;
  }
}

TEST(IntersectingTriangles, MayTouchOnlyInSharedVertices) {
  TriangleMesh mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 1}, {-1, 0, 2}}, {}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_TRUE(pairs_of(mesh).empty());
  mesh.positions.push_back({0, 0, 0});
  mesh.triangles = {{0, 1, 2}, {5, 3, 4}};
  EXPECT_EQ(pairs_of(mesh), (Pairs{{0, 1}}));
}

TEST(IntersectingTriangles, AreNoneWithoutTriangles) {
  EXPECT_TRUE(pairs_of({}).empty());
  TriangleMesh mesh = {{{0, 0, 0}}, {{0, 0, 0}}};
  EXPECT_EQ(pairs_of(mesh), (Pairs{{0, 0}}));
}

TEST(IntersectingTriangles, CanBeCancelled) {
  const TriangleMesh mesh = sheet(40, 0.0);
  const prefilter::Run run([](double) { return false; });
  EXPECT_THROW(intersecting_triangles({mesh.positions, mesh.triangles}, {}, run.with_threads(2)),
               Error);
}

TEST(PlaneSide, IsExactInAnObliquePlane) {
  // Points of a plane through the origin, as sums of two vectors, and one that is a unit above it.
  const Vector3 a = {3e5, -7e5, 1e5};
  const Vector3 b = {-2e5, 5e5, 9e5};
  const Vector3 o = {0, 0, 0};
  const Vector3 in = {1000003 * a[0] + 77 * b[0], 1000003 * a[1] + 77 * b[1],
                      1000003 * a[2] + 77 * b[2]};
  EXPECT_EQ(plane_side(o, a, b, in), 0);
  const Vector3 normal = cross(a, b);
  for (std::size_t i = 0; i < 3; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      Vector3 off = in;
      off[i] += sign * 0x1p-12;
      EXPECT_EQ(plane_side(o, a, b, off), sign * normal[i] > 0.0 ? 1 : -1);
    }
  }
}

}  // namespace
}  // namespace prefilter
