// SPDX-License-Identifier: GPL-3.0-or-later

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "prefilter/voxels/combine.h"
#include "prefilter/voxels/remesh/intersections.h"
#include "prefilter/voxels/tree_contour.h"
#include "prefilter/voxels/voxelize.h"
#include "voxels/contour/mesh_checks.h"

namespace prefilter {
namespace {

using testing::fault_of;

constexpr Box kRoot = {{-2.0, -2.0, -2.0}, {2.0, 2.0, 2.0}};

struct Cube {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int64_t, 3>> triangles;

  InputMesh mesh() const { return {positions, triangles}; }
};

// A cube of side 2, rotated about two axes.
Cube turned_cube(double about_z, double about_x, const Vector3& middle) {
  Cube cube;
  for (int i = 0; i < 8; ++i) {
    const Vector3 p = {(i & 1) * 2.0 - 1.0, ((i >> 1) & 1) * 2.0 - 1.0, (i >> 2) * 2.0 - 1.0};
    const double x = std::cos(about_z) * p[0] - std::sin(about_z) * p[1];
    const double y = std::sin(about_z) * p[0] + std::cos(about_z) * p[1];
    cube.positions.push_back(middle + Vector3{x, std::cos(about_x) * y - std::sin(about_x) * p[2],
                                              std::sin(about_x) * y + std::cos(about_x) * p[2]});
  }
  for (const auto& [a, b, c, d] : std::vector<std::array<std::int64_t, 4>>{
           {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    cube.triangles.push_back({a, b, c});
    cube.triangles.push_back({a, c, d});
  }
  return cube;
}

Octree tree_of(const Cube& cube) {
  VoxelizeOptions options;
  options.depth = 5;
  options.bounds = kRoot;
  return voxelize(cube.mesh(), options);
}

ContourOptions sharp(const std::vector<SourceMesh>& sources) {
  ContourOptions options;
  options.interpolant = Interpolant::kSharp;
  options.clean_up = false;
  options.sources = sources;
  return options;
}

void expect_sound(const TriangleMesh& mesh) {
  EXPECT_EQ(fault_of(mesh), "");
  EXPECT_TRUE(
      intersecting_triangles({mesh.positions, mesh.triangles}, {}, prefilter::Run(1)).empty());
}

TEST(Sharpen, CubesHaveTheirCorners) {
  const Cube cube = turned_cube(0.4, 0.7, {0.03, -0.02, 0.05});
  const Octree tree = tree_of(cube);
  const std::vector<SourceMesh> sources = {{cube.mesh(), {}}};
  for (const bool clean_up : {false, true}) {
    ContourOptions options = sharp(sources);
    options.clean_up = clean_up;
    const TriangleMesh mesh = contour_tree(tree.cells, tree.bounds, options);
    expect_sound(mesh);
    EXPECT_NEAR(testing::volume_of(mesh), 8.0, 5e-4);
    for (const Vector3& corner : cube.positions) {
      const auto is_there = [&](const Vector3& p) { return length(p - corner) < 1e-12; };
      EXPECT_TRUE(std::any_of(mesh.positions.begin(), mesh.positions.end(), is_there));
    }
  }
}

TEST(Sharpen, RimsOfCombinedShapesAreManifold) {
  const Cube first = turned_cube(0.4, 0.7, {-0.2, 0.0, 0.1});
  const Cube second = turned_cube(1.0, 0.3, {0.45, 0.35, -0.3});
  const std::vector<SourceMesh> sources = {{first.mesh(), {}}, {second.mesh(), {}}};
  for (const SetOperation operation :
       {SetOperation::kUnion, SetOperation::kIntersection, SetOperation::kDifference}) {
    const Octree tree = combine(tree_of(first), tree_of(second), operation, prefilter::Run(1));
    const TracedMesh traced = contour_traced(tree.cells, tree.bounds, sharp(sources));
    expect_sound(traced.mesh);
    ASSERT_EQ(traced.origins.size(), traced.mesh.triangles.size());
    EXPECT_TRUE(std::all_of(traced.origins.begin(), traced.origins.end(),
                            [](std::int64_t origin) { return origin >= 0 && origin < 24; }));
    EXPECT_TRUE(std::any_of(traced.origins.begin(), traced.origins.end(),
                            [](std::int64_t origin) { return origin >= 12; }));
  }
}

TEST(Sharpen, NeedsOneGroupPerTriangle) {
  const Cube cube = turned_cube(0.4, 0.7, {});
  const Octree tree = tree_of(cube);
  const std::vector<std::int32_t> groups(3);
  const std::vector<SourceMesh> sources = {{cube.mesh(), groups}};
  EXPECT_ANY_THROW(contour_tree(tree.cells, tree.bounds, sharp(sources)));
  EXPECT_ANY_THROW(contour_traced(tree.cells, tree.bounds, sharp({})));
}

TEST(Sharpen, WithoutSourcesCubesHaveTheirEdges) {
  const Cube cube = turned_cube(0.4, 0.7, {0.03, -0.02, 0.05});
  const Octree tree = tree_of(cube);
  const TriangleMesh mesh = contour_tree(tree.cells, tree.bounds, sharp({}));
  expect_sound(mesh);
  EXPECT_NEAR(testing::volume_of(mesh), 8.0, 0.01);
}

}  // namespace
}  // namespace prefilter
