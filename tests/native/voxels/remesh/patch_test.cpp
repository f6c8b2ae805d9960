// SPDX-License-Identifier: GPL-3.0-or-later

// Tests each phase of removing vertices.

#include "prefilter/voxels/remesh/patch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "prefilter/voxels/remesh/collapse.h"
#include "prefilter/voxels/remesh/collapse_check.h"
#include "prefilter/voxels/remesh/patch_links.h"
#include "prefilter/voxels/remesh/ring_shape.h"
#include "voxels/contour/mesh_checks.h"

namespace prefilter {
namespace {

using testing::fault_of;
using Triangle = std::array<std::int32_t, 3>;

Patch patch_of(const std::vector<Vector3>& positions, const std::vector<Triangle>& triangles) {
  Patch patch;
  patch.positions = positions;
  patch.flags.assign(positions.size(), Patch::kPending);
  patch.targets.assign(positions.size(), -1);
  for (const Triangle& corners : triangles) {
    patch.triangles.emplace_back();
    patch.triangles.back().corners = corners;
  }
  return patch;
}

// A torus of rows x columns squares of two triangles each, in random order and rotation.
Patch torus(int rows, int columns, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Vector3> positions;
  std::vector<Triangle> triangles;
  for (int i = 0; i < rows * columns; ++i) {
    const double u = 2.0 * std::numbers::pi * (i / columns) / rows;
    const double v = 2.0 * std::numbers::pi * (i % columns) / columns;
    const double around = 10.0 + 4.0 * std::cos(v);
    positions.push_back({around * std::cos(u), around * std::sin(u), 4.0 * std::sin(v)});
    const auto vertex = [&](int down, int along) {
      return (i / columns + down) % rows * columns + (i % columns + along) % columns;
    };
    const Triangle quad = {vertex(0, 0), vertex(1, 0), vertex(1, 1)};
    if (random() % 2 == 0) {
      triangles.push_back(quad);
      triangles.push_back({vertex(0, 0), vertex(1, 1), vertex(0, 1)});
    } else {
      triangles.push_back({vertex(0, 0), vertex(1, 0), vertex(0, 1)});
      triangles.push_back({vertex(1, 0), vertex(1, 1), vertex(0, 1)});
    }
  }
  for (Triangle& t : triangles) std::rotate(t.begin(), t.begin() + random() % 3, t.end());
  return patch_of(positions, triangles);
}

// The mesh without removed vertices and triangles.
TriangleMesh mesh_of(const Patch& patch) {
  TriangleMesh mesh;
  std::vector<std::int32_t> places(patch.positions.size(), -1);
  for (const PatchTriangle& t : patch.triangles) {
    if (t.corners[0] == t.corners[1]) continue;
    Triangle corners = t.corners;
    for (std::int32_t& v : corners) {
      std::int32_t& place = places[as_index(v)];
      if (place < 0) {
        place = static_cast<std::int32_t>(mesh.positions.size());
        mesh.positions.push_back(patch.point(v));
      }
      v = place;
    }
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

// The Euler characteristic V - E + F; each triangle has 3 half edges.
int characteristic(const TriangleMesh& mesh) {
  return static_cast<int>(mesh.positions.size()) - static_cast<int>(mesh.triangles.size()) / 2;
}

// Maps each neighbor of a vertex to the next one, found by a search over all triangles.
std::map<std::int32_t, std::int32_t> neighbors_of(const Patch& patch, std::int32_t vertex) {
  std::map<std::int32_t, std::int32_t> nexts;
  for (const PatchTriangle& t : patch.triangles) {
    if (t.corners[0] == t.corners[1]) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      if (t.corners[i] == vertex) nexts[t.corners[(i + 1) % 3]] = t.corners[(i + 2) % 3];
    }
  }
  return nexts;
}

// A pyramid over a polygon: vertex 0 is the tip.
Patch pyramid(const Vector3& tip, const std::vector<Vector3>& polygon) {
  std::vector<Vector3> positions = {tip};
  positions.insert(positions.end(), polygon.begin(), polygon.end());
  std::vector<Triangle> triangles;
  const auto count = static_cast<std::int32_t>(polygon.size());
  for (std::int32_t i = 0; i < count; ++i) triangles.push_back({0, 1 + i, 1 + (i + 1) % count});
  return patch_of(positions, triangles);
}

const std::vector<Vector3> kSquare = {{5, 5, 0}, {-5, 5, 0}, {-5, -5, 0}, {5, -5, 0}};

Ring ring_of(const Patch& patch, const PatchLinks& links, std::int32_t vertex) {
  Ring ring;
  std::vector<std::int32_t> slots(patch.positions.size());
  EXPECT_TRUE(find_ring(vertex, patch.triangles, links, &slots, &ring));
  return ring;
}

// The ring of a pyramid's tip, rotated so that spoke i leads to the polygon's vertex i.
struct Tip {
  Patch patch;
  Ring ring;
  RingShape shape;

  explicit Tip(Patch made) : patch(std::move(made)) {
    ring = ring_of(patch, link_corners(patch.positions.size(), patch.triangles), 0);
    measure_ring(patch, 0, ring, &shape);
  }
  std::size_t spoke_to(std::int32_t vertex) const {
    return static_cast<std::size_t>(std::find(ring.vertices.begin(), ring.vertices.end(), vertex) -
                                    ring.vertices.begin());
  }
};

TEST(PatchLinks, MatchASearchOverAllTrianglesAfterEachCollapse) {
  Patch patch = torus(7, 6, 1);
  PatchLinks links = link_corners(patch.positions.size(), patch.triangles);
  std::vector<std::int32_t> slots(patch.positions.size());
  std::mt19937 random(3);
  int collapses = 0;
  for (int step = 0; step < 400; ++step) {
    const auto u = static_cast<std::int32_t>(random() % patch.positions.size());
    if (links.count(u) == 0) continue;
    Ring ring;
    ASSERT_TRUE(find_ring(u, patch.triangles, links, &slots, &ring));
    const std::map<std::int32_t, std::int32_t> expected = neighbors_of(patch, u);
    ASSERT_EQ(ring.size, expected.size());
    for (std::size_t i = 0; i < ring.size; ++i) {
      EXPECT_EQ(expected.at(ring.vertices[i]), ring.vertices[ring.next(i)]);
      EXPECT_EQ(patch.triangle(ring.triangles[i]).corners[ring.corners[i]], u);
    }
    const Collapse which = {u, random() % ring.size};
    if (!keeps_manifold(patch, links, ring, which, &slots)) continue;
    collapse(ring, which, CollapseOutcome(), &patch, &links);
    ++collapses;
    ASSERT_EQ(characteristic(mesh_of(patch)), 0) << step;
  }
  EXPECT_GT(collapses, 20);
}

TEST(PatchLinks, HaveNoRingAtAVertexWithTwoFans) {
  // Two tetrahedra with a common vertex.
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2},
                                           {0, 4, 5}, {0, 5, 6}, {0, 6, 4}, {4, 6, 5}};
  const Patch patch = patch_of(std::vector<Vector3>(7), triangles);
  const PatchLinks links = link_corners(7, patch.triangles);
  std::vector<std::int32_t> slots(7);
  Ring ring;
  EXPECT_FALSE(find_ring(0, patch.triangles, links, &slots, &ring));
  EXPECT_TRUE(find_ring(1, patch.triangles, links, &slots, &ring));
}

TEST(RingShape, DescribesAPyramid) {
  const Tip tip(pyramid({0, 0, 2}, kSquare));
  EXPECT_NEAR(tip.shape.range, 2.0, 1e-12);
  EXPECT_FALSE(tip.shape.is_bent);  // 22 degrees
  EXPECT_TRUE(Tip(pyramid({0, 0, 5}, kSquare)).shape.is_bent);
  EXPECT_EQ(tip.shape.squared_height, 1.0);
  EXPECT_NEAR(tip.shape.sector_normals[0][2], 1.0, 1e-12);
  EXPECT_NEAR(length(tip.shape.normals[0]), 2 * 0.5 * 10 * std::sqrt(29.0), 1e-12);
  // A triangle with base 10 and height 0.05: a sliver, half as high as a tolerance of 0.1.
  const Tip thin(pyramid({0, 0, 0}, {{5, 0.05, 0}, {-5, 0.05, 0}, {0, -5, 0}}));
  EXPECT_TRUE(thin.shape.is_sliver[thin.spoke_to(1)]);
  EXPECT_FALSE(thin.shape.is_sliver[thin.spoke_to(2)]);
  EXPECT_NEAR(thin.shape.squared_height, 0.0025, 1e-12);
}

TEST(RingShape, HasTwoSectorsAlongACrease) {
  // A roof, whose ridge is along x.
  Patch roof =
      pyramid({0, 0, 3}, {{5, 0, 3}, {5, 5, 0}, {-5, 5, 0}, {-5, 0, 3}, {-5, -5, 0}, {5, -5, 0}});
  EXPECT_NEAR(Tip(roof).shape.range, 3.0, 1e-12);
  for (const auto& [triangle, side] : {std::pair{0, 0}, {5, 2}, {2, 2}, {3, 0}}) {
    roof.triangle(triangle).creases |= static_cast<std::uint8_t>(1U << side);
  }
  const Tip tip(roof);
  EXPECT_EQ(tip.ring.crease_count, 2U);
  EXPECT_NEAR(tip.shape.range, 0.0, 1e-12);
  for (const Vector3& normal : tip.shape.sector_normals) {
    EXPECT_NEAR(normal[2], 5.0 / std::sqrt(34.0), 1e-12);
  }
  const auto share = [&](std::int32_t a, std::int32_t b) {
    return share_sector(tip.ring, tip.shape, tip.spoke_to(a), tip.spoke_to(b));
  };
  EXPECT_TRUE(share(2, 3));
  EXPECT_FALSE(share(2, 5));
  EXPECT_TRUE(share(1, 2) && share(1, 6) && share(4, 5));  // the ends are on both
}

TEST(CollapseCheck, AllowsCollapsesThatKeepAManifold) {
  // Compares with performing the collapse, on meshes down to the smallest torus.
  for (unsigned seed = 0; seed < 12; ++seed) {
    Patch patch = seed % 3 == 0 ? torus(3, 3, seed) : torus(5, 4, seed);
    PatchLinks links = link_corners(patch.positions.size(), patch.triangles);
    std::vector<std::int32_t> slots(patch.positions.size());
    std::mt19937 random(seed);
    for (int step = 0; step < 60; ++step) {
      const auto u = static_cast<std::int32_t>(random() % patch.positions.size());
      if (links.count(u) == 0) continue;
      const Ring ring = ring_of(patch, links, u);
      const Collapse which = {u, random() % ring.size};
      const bool is_allowed = keeps_manifold(patch, links, ring, which, &slots);
      Patch copy = patch;
      for (PatchTriangle& t : copy.triangles) {
        for (std::int32_t& v : t.corners) v = v == u ? ring.vertices[which.spoke] : v;
        if (t.corners[0] == t.corners[1] || t.corners[1] == t.corners[2] ||
            t.corners[2] == t.corners[0]) {
          t.corners.fill(0);
        }
      }
      // Random positions, so that only connectivity counts.
      for (Vector3& p : copy.positions) {
        for (double& x : p) x = static_cast<double>(random());
      }
      ASSERT_EQ(is_allowed, fault_of(mesh_of(copy)) == "") << seed << " " << step;
      if (is_allowed) collapse(ring, which, CollapseOutcome(), &patch, &links);
    }
  }
}

TEST(CollapseCheck, RefusesSharedEdges) {
  // Two vertices shared with other patches must not get an edge, since another patch may add the
  // same one.
  Patch patch = torus(8, 8, 2);
  const PatchLinks links = link_corners(patch.positions.size(), patch.triangles);
  const Ring ring = ring_of(patch, links, 20);
  std::vector<std::int32_t> slots(patch.positions.size());
  ASSERT_GE(ring.size, 4U);
  ASSERT_TRUE(keeps_manifold(patch, links, ring, {20, 0}, &slots));
  patch.flags[as_index(ring.vertices[0])] |= Patch::kShared;
  EXPECT_TRUE(keeps_manifold(patch, links, ring, {20, 0}, &slots));
  patch.flags[as_index(ring.vertices[2])] |= Patch::kShared;
  EXPECT_FALSE(keeps_manifold(patch, links, ring, {20, 0}, &slots));
}

TEST(CollapseCheck, RefusesThinOrInvertedTriangles) {
  NewTriangles made;
  const auto makes = [&](const Patch& patch, std::int32_t to) {
    const Tip tip(patch);
    return make_triangles(patch, tip.ring, tip.shape, {0, tip.spoke_to(to)}, &made);
  };
  // 29 and 31 degrees from the square.
  for (const auto& [height, is_made] : {std::pair{2.77, true}, {3.01, false}}) {
    EXPECT_EQ(makes(pyramid({0, 0, height}, kSquare), 1), is_made);
  }
  // A notch: a collapse to vertex 1 would invert a triangle.
  const Patch notched =
      pyramid({0, -1, 0}, {{5, 5, 0}, {0, 1, 0}, {-5, 5, 0}, {-5, -5, 0}, {5, -5, 0}});
  EXPECT_FALSE(makes(notched, 1));
  EXPECT_TRUE(makes(notched, 2));
  // A height of 0.9 tolerances.
  const Patch low = pyramid({0, 1.5, 0}, {{5, 0.9, 0}, {0, 9, 0}, {-5, 0, 0}, {0, 0.0, 0}});
  EXPECT_FALSE(makes(low, 1));
}

TEST(CollapseCheck, KeepsCreasesStraight) {
  Patch roof =
      pyramid({0, 0, 3}, {{5, 0, 3}, {5, 5, 0}, {-5, 5, 0}, {-5, 0.8, 3}, {-5, -5, 0}, {5, -5, 0}});
  for (const auto& [triangle, side] : {std::pair{0, 0}, {5, 2}, {2, 2}, {3, 0}}) {
    roof.triangle(triangle).creases |= static_cast<std::uint8_t>(1U << side);
  }
  const auto outcome = [](const Patch& patch, std::int32_t to) {
    const Tip tip(patch);
    return crease_outcome(patch, tip.ring, {0, tip.spoke_to(to)});
  };
  // Distance of the tip from the line between the ends, from the area of their triangle.
  const double moved = 0.8 * 5 / std::hypot(10.0, 0.8);
  EXPECT_TRUE(outcome(roof, 1).is_kept);
  EXPECT_NEAR(outcome(roof, 1).moved, moved, 1e-12);
  EXPECT_NEAR(outcome(roof, 1).error, moved, 1e-12);
  roof.triangle(0).crease_errors[0] = 0.7F;
  EXPECT_FALSE(outcome(roof, 1).is_kept);
  roof.triangle(0).crease_errors[0] = 0.0F;
  roof.positions[4] = {0.5, 0.3, 3};  // turns back
  EXPECT_FALSE(outcome(roof, 1).is_kept);
  // A crease that ends at 1 must not merge with one that leaves the tip.
  Patch beside = pyramid({0, 0, 0}, kSquare);
  EXPECT_TRUE(outcome(beside, 1).is_kept);
  beside.triangle(0).creases = 1U << 1U;  // from 1 to 2
  EXPECT_TRUE(outcome(beside, 1).is_kept);
  beside.triangle(0).creases |= 1U << 2U;  // from 2 to the tip
  beside.triangle(1).creases |= 1U << 0U;
  EXPECT_FALSE(outcome(beside, 1).is_kept);
}

double distance_between(const Vector3& p, const Vector3& u, const Vector3& q, const Vector3& v) {
  // Distance between two segments by sampling.
  constexpr int kSteps = 2000;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    const Vector3 at = p + (static_cast<double>(i) / kSteps) * u;
    const double along = std::clamp(dot(at - q, v) / dot(v, v), 0.0, 1.0);
    least = std::min(least, length(at - (q + along * v)));
  }
  return least;
}

TEST(CollapseCheck, MeasuresEdgesWhereTheyCross) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-0.45, 0.45);
  int crossed = 0;
  for (int round = 0; round < 60; ++round) {
    std::vector<Vector3> polygon;
    for (int i = 0; i < 7; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / 7;
      polygon.push_back({9 * std::cos(angle), 9 * std::sin(angle), uniform(random)});
    }
    const Tip tip(pyramid({6 * uniform(random), 6 * uniform(random), uniform(random)}, polygon));
    const std::size_t spoke = random() % 7;
    const Vector3& from = tip.patch.point(0);
    const Vector3& to = tip.patch.point(tip.ring.vertices[spoke]);
    double expected = 0.0;
    double most = 0.0;
    std::size_t far = 0;
    for (std::size_t i = 0; i < 7; ++i) {
      for (std::size_t j = 0; j < 7; ++j) {
        if (i == spoke || j == spoke || i == j) continue;
        if (j == tip.ring.next(spoke) || j == tip.ring.before(spoke)) continue;
        const Vector3 p = tip.patch.point(tip.ring.vertices[i]);
        const Vector3 q = tip.patch.point(tip.ring.vertices[j]);
        // Distances are measured from above, where heights are small compared with the other sizes.
        const Vector3 u = p - from;
        const Vector3 v = q - to;
        most = std::max(most, distance_between(from, u, to, v));
        const double size = u[0] * v[1] - u[1] * v[0];
        const Vector3 d = to - from;
        const double along = (d[0] * v[1] - d[1] * v[0]) / size;
        const double other = (d[0] * u[1] - d[1] * u[0]) / size;
        if (along < 0.02 || along > 0.98 || other < 0.02 || other > 0.98) continue;
        const double gap = distance_between(from, u, to, v);
        expected = std::max(expected, gap);
        far += gap > 0.1 ? 1 : 0;
      }
    }
    std::vector<Vector3> crossings;
    const double found =
        measure_crossings(tip.patch, tip.ring, tip.shape, {0, spoke}, 10.0, &crossings);
    EXPECT_GE(found, expected - 1e-4);
    EXPECT_LE(found, most + 1e-9);
    EXPECT_GE(crossings.size() + 1, far);
    crossed += expected > 0.1 ? 1 : 0;
    if (expected > 0.02) {
      EXPECT_EQ(
          measure_crossings(tip.patch, tip.ring, tip.shape, {0, spoke}, 0.5 * expected, &crossings),
          -1.0);
    }
  }
  EXPECT_GT(crossed, 10);
}

TEST(CollapseCheck, MeasuresSamplesOnBothSurfaces) {
  const Tip tip(pyramid({0, 0, 0.8}, kSquare));
  NewTriangles made;
  ASSERT_TRUE(make_triangles(tip.patch, tip.ring, tip.shape, {0, tip.spoke_to(1)}, &made));
  std::vector<Vector3> crossings;
  // The farthest point is the middle of the new edge, below the pyramid.
  const double found =
      measure_samples(tip.patch, tip.ring, made, {0, tip.spoke_to(1)}, 1.0, &crossings);
  EXPECT_NEAR(found, 0.8 * 5 / std::hypot(5.0, 0.8), 1e-12);
  for (const Vector3& p : crossings) EXPECT_GT(p[2], 0.1);
  EXPECT_EQ(crossings.size(), 4U * 4U);  // three on each edge, and the middles
  EXPECT_EQ(measure_samples(tip.patch, tip.ring, made, {0, tip.spoke_to(1)}, 0.5, &crossings),
            -1.0);
}

TEST(CollapseCheck, FindsTheNearestTriangleOrOneThatIsVeryNear) {
  const Tip tip(pyramid({0, 0, 0}, kSquare));
  const std::size_t spoke = tip.spoke_to(1);
  NewTriangles made;
  ASSERT_TRUE(make_triangles(tip.patch, tip.ring, tip.shape, {0, spoke}, &made));
  double farthest = 0.0;
  const auto near = [&](const Vector3& p, std::size_t hint, double most) {
    return find_nearest(made, tip.ring, spoke, p, hint, most, &farthest);
  };
  const auto left = static_cast<std::int32_t>(tip.spoke_to(2));
  const auto below = static_cast<std::int32_t>(tip.spoke_to(3));
  EXPECT_EQ(near({-4, 3, 0.9}, spoke, 1.0), left);
  EXPECT_NEAR(farthest, 0.81, 1e-12);
  EXPECT_EQ(near({-4, 3, 0.1}, as_index(below), 1.0), left);
  EXPECT_EQ(near({-0.4, 0.4, 0.1}, as_index(below), 1.0), left);   // 0.58: not near enough
  EXPECT_EQ(near({-0.1, 0.1, 0.1}, as_index(below), 1.0), below);  // 0.17 away: near enough
  EXPECT_EQ(near({0, 0, 1.1}, spoke, 1.0), -1);
  EXPECT_NEAR(farthest, 0.81, 1e-12);
}

TEST(CollapseCheck, AccumulatesSmallErrorsAndKeepsOtherPoints) {
  NewTriangles made;
  const auto check = [&](const Patch& patch, CollapseOutcome* outcome) {
    const Tip tip(patch);
    const Collapse which = {0, tip.spoke_to(1)};
    EXPECT_TRUE(make_triangles(patch, tip.ring, tip.shape, which, &made));
    return is_within_tolerance(patch, tip.ring, tip.shape, made, {}, which, outcome);
  };
  CollapseOutcome outcome;
  Patch patch = pyramid({0, 0, 0.1}, kSquare);
  EXPECT_TRUE(check(patch, &outcome));
  EXPECT_FALSE(outcome.adds_points);
  EXPECT_NEAR(outcome.error, 0.1, 1e-12);
  patch.triangle(2).error = 0.2F;
  EXPECT_TRUE(check(patch, &outcome));
  EXPECT_TRUE(outcome.adds_points);
  EXPECT_NEAR(outcome.error, 0.2, 1e-6);
  ASSERT_EQ(outcome.added.size(), 1U);
  EXPECT_EQ(outcome.added[0], patch.point(0));
  // The triangle's points are measured again, and one is too far away.
  patch = pyramid({0, 0, 0.1}, kSquare);
  patch.points = {{{-1, -1, 0.5}, -1}};
  patch.triangle(2).first_point = 0;
  EXPECT_TRUE(check(patch, &outcome));
  EXPECT_EQ(outcome.placements.size(), 2U);
  EXPECT_GT(outcome.deviation, 0.09);
  patch.points[0].position[2] = 1.1;
  EXPECT_FALSE(check(patch, &outcome));
  EXPECT_FALSE(check(pyramid({0, 0, 1.05}, kSquare), &outcome));
}

// Sets the crease bit in both triangles of the edge.
void set_crease(std::int32_t a, std::int32_t b, Patch* patch) {
  for (PatchTriangle& t : patch->triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t from = t.corners[i];
      const std::int32_t to = t.corners[(i + 1) % 3];
      if ((from != a || to != b) && (from != b || to != a)) continue;
      t.creases = static_cast<std::uint8_t>(t.creases | (1U << i));
      t.crease_errors[i] = 0.375F;
    }
  }
}

TEST(Collapse, KeepsPointsAndCreases) {
  Patch patch = torus(8, 8, 5);
  PatchLinks links = link_corners(patch.positions.size(), patch.triangles);
  const Ring ring = ring_of(patch, links, 20);
  // One crease from the vertex to the neighbor after the spoke, one from the spoke's end to the
  // neighbor before it.
  const std::int32_t to = ring.vertices[0];
  const std::int32_t after = ring.vertices[1];
  const std::int32_t before = ring.vertices[ring.size - 1];
  set_crease(20, after, &patch);
  set_crease(to, before, &patch);
  CollapseOutcome outcome;
  outcome.adds_points = true;
  outcome.error = 0.25;
  outcome.crease_error = 0.5;
  outcome.added = {{1, 2, 3}, {4, 5, 6}};
  patch.points = {{{7, 8, 9}, -1}};
  patch.triangle(ring.triangles[2]).first_point = 0;
  outcome.placements = {{-1, 1}, {0, 2}, {-1, 2}};
  Ring with = ring_of(patch, links, 20);
  const auto shift = static_cast<std::size_t>(
      std::find(with.vertices.begin(), with.vertices.end(), to) - with.vertices.begin());
  for (CollapseOutcome::Placement& place : outcome.placements) {
    place.triangle = static_cast<std::int32_t>((as_index(place.triangle) + shift) % with.size);
  }
  collapse(with, {20, shift}, outcome, &patch, &links);
  EXPECT_EQ(patch.targets[20], to);
  std::map<std::pair<std::int32_t, std::int32_t>, std::pair<bool, float>> creases;
  std::multiset<std::array<double, 3>> points;
  for (const PatchTriangle& t : patch.triangles) {
    if (t.corners[0] == t.corners[1]) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      creases[{t.corners[i], t.corners[(i + 1) % 3]}] = {((t.creases >> i) & 1U) != 0,
                                                         t.crease_errors[i]};
    }
    for (std::int32_t p = t.first_point; p >= 0; p = patch.points[as_index(p)].next) {
      const Vector3& at = patch.points[as_index(p)].position;
      points.insert({at[0], at[1], at[2]});
    }
  }
  for (const auto& [side, known] : creases) {
    EXPECT_EQ(known, creases.at({side.second, side.first}));
    const std::int32_t other = side.first == to ? side.second : side.first;
    const bool is_expected =
        (side.first == to || side.second == to) && (other == after || other == before);
    EXPECT_EQ(known.first, is_expected);
  }
  EXPECT_EQ(creases.at({to, after}).second, 0.5F);
  EXPECT_EQ(creases.at({to, before}).second, 0.375F);
  const std::multiset<std::array<double, 3>> expected = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  EXPECT_EQ(points, expected);
  for (std::size_t i = 1; i + 1 < ring.size; ++i) {
    EXPECT_EQ(patch.triangle(ring.triangles[i]).error, 0.25F);
    EXPECT_TRUE(patch.triangle(ring.triangles[i]).is_new);
  }
}

TEST(SimplifyPatch, KeepsTheGenus) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    Patch patch = torus(30, 20, seed);
    patch.spacing = 1.0;
    simplify_patch(&patch);
    const TriangleMesh mesh = mesh_of(patch);
    EXPECT_EQ(fault_of(mesh), "");
    EXPECT_EQ(characteristic(mesh), 0);
    EXPECT_LT(mesh.triangles.size(), 400U);
    for (std::size_t v = 0; v < patch.positions.size(); ++v) {
      const bool is_there =
          std::any_of(patch.triangles.begin(), patch.triangles.end(), [&](const PatchTriangle& t) {
            return t.corners[0] != t.corners[1] &&
                   std::count(t.corners.begin(), t.corners.end(), static_cast<std::int32_t>(v)) > 0;
          });
      EXPECT_EQ(is_there, patch.targets[v] < 0);
    }
  }
}

}  // namespace
}  // namespace prefilter
