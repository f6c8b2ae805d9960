// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/smooth_stairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "prefilter/voxels/remesh/near_intersections.h"

namespace prefilter {
namespace {

constexpr int kWidth = 24;

// A roof of 90 degrees along y over a grid of unit cells. The vertices of its ridge alternate
// between its sides in pairs, half a cell from the true ridge.
FacetedMesh stairs() {
  constexpr int kRidge = kWidth / 2;
  FacetedMesh mesh;
  for (int y = 0; y <= kWidth; ++y) {
    for (int x = 0; x <= kWidth; ++x) {
      const double off = x != kRidge ? 0.0 : y / 2 % 2 == 0 ? 0.5 : -0.5;
      mesh.positions.push_back({x + off, 1.0 * y, -std::abs(x + off - kRidge)});
    }
  }
  for (std::int32_t y = 0; y < kWidth; ++y) {
    for (std::int32_t x = 0; x < kWidth; ++x) {
      const std::int32_t a = y * (kWidth + 1) + x;
      const std::int32_t b = a + kWidth + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  }
  return mesh;
}

std::size_t ridge_vertex(int y) { return static_cast<std::size_t>(y * (kWidth + 1) + kWidth / 2); }

const auto kAnywhere = [](const Vector3&) { return true; };

TEST(SmoothStairs, ARidgeIsEven) {
  FacetedMesh mesh = stairs();
  const FacetedMesh before = mesh;
  smooth_stairs(1.0, kAnywhere, false, prefilter::Run(2), &mesh);
  for (int y = 6; y <= kWidth - 6; ++y) {
    const Vector3& p = mesh.positions[ridge_vertex(y)];
    EXPECT_NEAR(p[0], kWidth / 2, 0.15);
    // The stairs are half a cell below the true ridge, and rounding lowers them by less than that.
    EXPECT_GT(p[2], -1.0);
    EXPECT_LT(p[2], 0.0);
  }
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_LE(std::abs(mesh.positions[v][a] - before.positions[v][a]), 0.5);
    }
    // Vertices farther than three cells from the ridge stay.
    if (std::abs(before.positions[v][0] - kWidth / 2) > 3.0) {
      EXPECT_EQ(mesh.positions[v], before.positions[v]);
    }
  }
}

TEST(SmoothStairs, MoveOnlyTheRidgeIfNothingIsFree) {
  FacetedMesh mesh = stairs();
  const FacetedMesh before = mesh;
  smooth_stairs(
      1.0, [](const Vector3&) { return false; }, false, prefilter::Run(2), &mesh);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    // Vertices with triangles on both sides are within 1.5 cells of the ridge.
    if (std::abs(before.positions[v][0] - kWidth / 2) > 1.5) {
      EXPECT_EQ(mesh.positions[v], before.positions[v]);
    }
  }
  for (int y = 6; y <= kWidth - 6; ++y) {
    EXPECT_NEAR(mesh.positions[ridge_vertex(y)][0], kWidth / 2, 0.15);
  }
}

TEST(SmoothStairs, KeepPlacedAndFlatVertices) {
  FacetedMesh mesh = stairs();
  const FacetedMesh before = mesh;
  mesh.kinds.assign(mesh.positions.size(), VertexKind::kEdge);
  smooth_stairs(1.0, kAnywhere, false, prefilter::Run(1), &mesh);
  EXPECT_EQ(mesh.positions, before.positions);
  mesh.kinds.clear();
  smooth_stairs(
      1.0, [](const Vector3&) { return false; }, true, prefilter::Run(1), &mesh);
  EXPECT_EQ(mesh.positions, before.positions);
  FacetedMesh flat = before;
  for (Vector3& p : flat.positions) p[2] = 0.25 * p[0];
  const std::vector<Vector3> plane = flat.positions;
  smooth_stairs(1.0, kAnywhere, false, prefilter::Run(1), &flat);
  EXPECT_EQ(flat.positions, plane);
}

TEST(SmoothStairs, AvoidObstacles) {
  const FacetedMesh before = stairs();
  FacetedMesh mesh = before;
  smooth_stairs(1.0, kAnywhere, false, prefilter::Run(1), &mesh);
  std::size_t at = ridge_vertex(6);
  const auto drop = [&](std::size_t v) { return before.positions[v][2] - mesh.positions[v][2]; };
  for (int y = 7; y <= kWidth - 6; ++y) {
    if (drop(ridge_vertex(y)) > drop(at)) at = ridge_vertex(y);
  }
  ASSERT_GT(drop(at), 0.05);
  // A vertical triangle below the vertex, from just below the surface to far below the smoothed
  // one.
  FacetedMesh both = before;
  const Vector3 tip = before.positions[at];
  const auto first = static_cast<std::int32_t>(both.positions.size());
  both.positions.push_back({tip[0] - 0.01, tip[1], tip[2] - 0.3 * drop(at)});
  both.positions.push_back({tip[0] + 0.01, tip[1], tip[2] - 0.3 * drop(at)});
  both.positions.push_back({mesh.positions[at][0], tip[1], tip[2] - 3.0});
  both.triangles.push_back({first, first + 1, first + 2});
  both.kinds.assign(both.positions.size(), VertexKind::kSurface);
  std::fill(both.kinds.end() - 3, both.kinds.end(), VertexKind::kEdge);
  smooth_stairs(1.0, kAnywhere, false, prefilter::Run(1), &both);
  const MeshView<std::int32_t> view{both.positions, both.triangles};
  EXPECT_TRUE(near_intersections(view, 0, std::vector<std::uint8_t>(both.triangles.size(), 1), 2.0,
                                 prefilter::Run(1))
                  .empty());
  // Vertices far from it are smoothed as before.
  EXPECT_EQ(both.positions[ridge_vertex(kWidth - 2)], mesh.positions[ridge_vertex(kWidth - 2)]);
}

}  // namespace
}  // namespace prefilter
