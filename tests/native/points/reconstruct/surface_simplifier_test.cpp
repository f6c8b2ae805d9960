// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/surface_simplifier.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "prefilter/base/error.h"
#include "prefilter/geometry/nearest.h"
#include "prefilter/points/array_sink.h"

namespace prefilter {
namespace {

constexpr int kSide = 48;
constexpr std::size_t kWidth = 3;  // x, and the support

using Triangle = std::array<std::int32_t, 3>;

double flat(const Vector3&) { return 0.0; }
double hilly(const Vector3& p) { return 3.0 * std::sin(0.2 * p[0]) * std::cos(0.15 * p[1]); }
// Distance of a point of the square from the samples.
double nowhere(const Vector3&) { return 0.5; }
double in_a_hole(const Vector3& p) {
  return std::max(0.5, 8.0 - std::hypot(p[0] - 20.0, p[1] - 22.0));
}

using Field = double (*)(const Vector3&);

struct Square {
  Field height = flat;
  Field distance = nowhere;
  double tolerance = 0.05;
  int rows = kSide;  // of a part
  int lag = 0;       // so many more rows may be named by later parts
  bool has_support = true;
};

struct Mesh {
  std::vector<Vector3> positions;
  std::vector<Triangle> triangles;
  std::vector<float> attributes;
};

std::int64_t number(int x, int y) { return y * (kSide + 1) + x; }

// Adds the rows of unit cells from `low` to `high`.
void add_rows(const Square& square, int low, int high, MeshSink* sink) {
  std::vector<Vector3> positions;
  std::vector<float> attributes;
  for (int y = low == 0 ? 0 : low + 1; y <= high; ++y) {
    for (int x = 0; x <= kSide; ++x) {
      Vector3 p = {1.0 * x, 1.0 * y, 0.0};
      attributes.insert(attributes.end(),
                        {static_cast<float>(x), static_cast<float>(square.distance(p)), 1.0F});
      p[2] = square.height(p);
      positions.push_back(p);
    }
  }
  std::vector<std::array<std::int64_t, 3>> triangles;
  for (int y = low; y < high; ++y) {
    for (int x = 0; x < kSide; ++x) {
      triangles.push_back({number(x, y), number(x + 1, y), number(x + 1, y + 1)});
      triangles.push_back({number(x, y), number(x + 1, y + 1), number(x, y + 1)});
    }
  }
  sink->add_vertices(std::move(positions), std::move(attributes));
  sink->add_triangles(std::move(triangles));
}

Mesh simplified(const Square& square, const prefilter::Run& run = prefilter::Run()) {
  ArraySink sink;
  SurfaceSimplifier simplifier({square.tolerance, kWidth, square.has_support, run}, &sink);
  for (int low = 0; low < kSide; low += square.rows) {
    const int high = std::min(low + square.rows, kSide);
    add_rows(square, low, high, &simplifier);
    std::vector<std::int64_t> shared;
    for (int y = std::max(high - square.lag, 0); y <= high && high < kSide; ++y) {
      for (int x = 0; x <= kSide; ++x) shared.push_back(number(x, y));
    }
    simplifier.end_part(shared);
  }
  Mesh mesh{sink.take_positions(), sink.take_triangles(), sink.take_attributes()};
  EXPECT_EQ(simplifier.counts().vertices, mesh.positions.size());
  EXPECT_EQ(simplifier.counts().triangles, mesh.triangles.size());
  return mesh;
}

Mesh unchanged(const Square& square) {
  ArraySink sink;
  add_rows(square, 0, kSide, &sink);
  return {sink.take_positions(), sink.take_triangles(), sink.take_attributes()};
}

double largest_distance(const Mesh& from, const Mesh& to) {
  std::vector<Vector3> points = from.positions;
  for (const auto& [a, b, c] : from.triangles) {
    const auto at = [&](std::int32_t v) { return from.positions[static_cast<std::size_t>(v)]; };
    points.push_back((1.0 / 3.0) * (at(a) + at(b) + at(c)));
    points.push_back(0.5 * (at(a) + at(b)));
  }
  double largest = 0.0;
  for (const SurfacePoint& found :
       nearest_points(points, {to.positions, to.triangles}, prefilter::Run(1))) {
    largest = std::max(largest, found.distance);
  }
  return largest;
}

// The directed edges, each at most once.
std::set<std::pair<std::int32_t, std::int32_t>> directed_edges(const Mesh& mesh) {
  std::set<std::pair<std::int32_t, std::int32_t>> edges;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_TRUE(edges.insert({t[i], t[(i + 1) % 3]}).second);
    }
  }
  return edges;
}

// Vertices stay on the square and keep their attributes; all border vertices are kept, and there
// are no other borders.
void expect_same_square(const Mesh& mesh, const Square& square) {
  const auto edges = directed_edges(mesh);
  int ends = 0;
  for (const auto& [a, b] : edges) {
    if (edges.contains({b, a})) continue;
    ++ends;
    for (const std::int32_t v : {a, b}) {
      const Vector3& p = mesh.positions[static_cast<std::size_t>(v)];
      EXPECT_TRUE(p[0] == 0.0 || p[0] == kSide || p[1] == 0.0 || p[1] == kSide);
    }
  }
  EXPECT_EQ(ends, 4 * kSide);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vector3& p = mesh.positions[v];
    EXPECT_EQ(p[0], std::round(p[0]));
    EXPECT_EQ(p[2], square.height({p[0], p[1], 0.0}));
    EXPECT_EQ(mesh.attributes[v * kWidth], static_cast<float>(p[0]));
    EXPECT_EQ(mesh.attributes[v * kWidth + 1],
              static_cast<float>(square.distance({p[0], p[1], 0.0})));
  }
}

TEST(SurfaceSimplifier, StaysWithinTheToleranceInAnyParts) {
  for (const int rows : {kSide, 20, 8, 3, 1}) {
    for (const double tolerance : {0.02, 0.2}) {
      const Square square{.height = hilly, .tolerance = tolerance, .rows = rows};
      const Mesh before = unchanged(square);
      const Mesh after = simplified(square);
      expect_same_square(after, square);
      EXPECT_LT(after.triangles.size(), before.triangles.size());
      EXPECT_LE(largest_distance(before, after), tolerance) << rows;
      EXPECT_LE(largest_distance(after, before), tolerance) << rows;
    }
  }
}

TEST(SurfaceSimplifier, SimplifiesAcrossParts) {
  // All border vertices are kept, and each belongs to one or two triangles.
  constexpr std::size_t kBorder = 4 * kSide;
  for (const int rows : {kSide, 16, 8}) {
    const Mesh mesh = simplified({.rows = rows});
    EXPECT_GE(mesh.triangles.size(), kBorder - 2);
    EXPECT_LT(mesh.triangles.size(), 3 * kBorder) << rows;
  }
}

TEST(SurfaceSimplifier, LaterPartsMayUseSharedVertices) {
  const Square square{.height = hilly, .tolerance = 0.1, .rows = 4, .lag = 9};
  expect_same_square(simplified(square), square);
}

TEST(SurfaceSimplifier, KeepsPartsThatCanStillBeCut) {
  Square square{.distance = in_a_hole, .rows = 16};
  const auto far_count = [&](const Mesh& mesh) {
    std::size_t count = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      count += mesh.attributes[v * kWidth + 1] > 1.5F ? 1U : 0U;
    }
    return count;
  };
  const std::size_t all = far_count(unchanged(square));
  EXPECT_GT(all, 100U);
  EXPECT_EQ(far_count(simplified(square)), all);
  square.has_support = false;
  EXPECT_LT(far_count(simplified(square)), all / 10);
}

TEST(SurfaceSimplifier, IsTheSameForAnyThreads) {
  const Square square{.height = hilly, .rows = 12};
  const Mesh one = simplified(square, prefilter::Run(1));
  const Mesh other = simplified(square, prefilter::Run(3));
  EXPECT_EQ(one.positions, other.positions);
  EXPECT_EQ(one.triangles, other.triangles);
}

TEST(SurfaceSimplifier, AcceptsNonManifoldMeshes) {
  // Three squares at one edge and a duplicate triangle: non-manifold parts are kept unchanged.
  ArraySink sink;
  SurfaceSimplifier simplifier({1.0, 0, false, prefilter::Run(1)}, &sink);
  simplifier.add_vertices({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {});
  simplifier.add_triangles({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {0, 1, 4}});
  simplifier.end_part({});
  EXPECT_EQ(sink.take_triangles().size(), 4U);
  simplifier.end_part({});
  EXPECT_EQ(simplifier.counts().vertices, 5U);
}

TEST(SurfaceSimplifier, StopsWhenAsked) {
  const prefilter::Run run([](double) { return false; });
  EXPECT_THROW(simplified({.height = hilly}, run.with_threads(1)), Error);
}

}  // namespace
}  // namespace prefilter
