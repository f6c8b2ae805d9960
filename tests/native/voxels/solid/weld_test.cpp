// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/weld.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

namespace prefilter {
namespace {

using Triangle = std::array<std::int32_t, 3>;

WorkMesh mesh_of(std::vector<Vector3> positions, std::vector<Triangle> triangles) {
  WorkMesh mesh{std::move(positions), std::move(triangles), {}};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    mesh.origins.push_back(static_cast<std::int64_t>(t));
  }
  return mesh;
}

// Rotates a triangle so that its lowest corner is first.
Triangle from_lowest(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

TEST(DropDuplicates, KeepsTheFirstOfTheMoreFrequentOrientation) {
  std::mt19937 random(4);
  std::vector<Triangle> triangles;
  for (int i = 0; i < 3000; ++i) {
    triangles.push_back({static_cast<std::int32_t>(random() % 7),
                         static_cast<std::int32_t>(random() % 7),
                         static_cast<std::int32_t>(random() % 7)});
  }
  for (const std::size_t count : {1U, 2U, 20U, 120U, 3000U}) {
    WorkMesh mesh =
        mesh_of(std::vector<Vector3>(7), {triangles.begin(), triangles.begin() + count});
    // Reference: triangles by their set of corners, then by orientation.
    std::map<std::set<std::int32_t>, std::map<Triangle, std::vector<std::size_t>>> all;
    std::size_t whole = 0;
    for (std::size_t t = 0; t < count; ++t) {
      const std::set<std::int32_t> corners(triangles[t].begin(), triangles[t].end());
      if (corners.size() < 3) continue;
      ++whole;
      all[corners][from_lowest(triangles[t])].push_back(t);
    }
    std::vector<std::size_t> expected;
    for (const auto& [corners, ways] : all) {
      const std::vector<std::size_t>* best = nullptr;
      for (const auto& [way, own] : ways) {
        if (best == nullptr || own.size() > best->size() ||
            (own.size() == best->size() && own.front() < best->front())) {
          best = &own;
        }
      }
      expected.push_back(best->front());
    }
    std::sort(expected.begin(), expected.end());
    const std::size_t dropped = drop_duplicates(&mesh, prefilter::Run(2));
    ASSERT_EQ(mesh.triangles.size(), expected.size());
    EXPECT_EQ(dropped, whole - expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(mesh.triangles[i], triangles[expected[i]]);
      EXPECT_EQ(mesh.origins[i], static_cast<std::int64_t>(expected[i]));
    }
  }
}

TEST(WeldEqual, MapsToTheFirstVertexAtEachPosition) {
  WorkMesh mesh =
      mesh_of({{0, 0, 0}, {1, 0, 0}, {-0.0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 4}, {2, 4, 3}});
  EXPECT_EQ(weld_equal(&mesh, prefilter::Run(1)), 2U);
  EXPECT_EQ(mesh.triangles[1], (Triangle{0, 4, 1}));
}

// Two triangles with parallel edges `apart` from each other; the lower one has this height.
WorkMesh two(double apart, double height) {
  return mesh_of(
      {{0, 0, 0}, {1, 0, 0}, {0.5, -height, 0}, {0, apart, 0}, {1, apart, 0}, {0.5, 3, 0}},
      {{1, 0, 2}, {3, 4, 5}});
}

TEST(WeldBorders, WeldsNearVerticesButNotCornersOfOneTriangle) {
  for (const auto& [apart, expected] : {std::pair(0.09, 2U), std::pair(0.11, 0U)}) {
    WorkMesh mesh = two(apart, 1.0);
    EXPECT_EQ(weld_borders(&mesh, 0.1, prefilter::Run(1)), expected) << apart;
    EXPECT_EQ(mesh.triangles[1] == (Triangle{0, 1, 5}), expected == 2);
  }
  // Edges of length 1 may be shortened by a third.
  WorkMesh near = two(0.33, 2.0);
  EXPECT_EQ(weld_borders(&near, 10.0, prefilter::Run(1)), 2U);
  WorkMesh far = two(0.34, 2.0);
  EXPECT_EQ(weld_borders(&far, 10.0, prefilter::Run(1)), 0U);
}

TEST(SplitBorders, SplitsWhereFinerBordersMeetCoarserOnes) {
  // An edge from 0 to 1, with the end of another edge near it.
  const auto splits = [](const Vector3& point, double distance) {
    WorkMesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {0.5, -1, 0}, point, {0.4, 3, 0}, {0.6, 3, 0}},
                            {{1, 0, 2}, {3, 4, 5}});
    const std::size_t count = split_borders(&mesh, distance, prefilter::Run(1));
    EXPECT_EQ(mesh.triangles.size(), 2U + count);
    double area = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      EXPECT_EQ(mesh.origins[t], t == 1 ? 1 : 0);
      const auto [a, b, c] = mesh.corners(t);
      if (t != 1) area += cross(b - a, c - a)[2] / 2.0;
    }
    EXPECT_NEAR(area, 0.5, 0.06);
    return count;
  };
  EXPECT_EQ(splits({0.3, 0.09, 0}, 0.1), 1U);
  EXPECT_EQ(splits({0.3, 0.11, 0}, 0.1), 0U);
  EXPECT_EQ(splits({0.11, 0.0, 0}, 0.1), 1U);
  EXPECT_EQ(splits({0.09, 0.0, 0}, 0.1), 0U);  // that close to an end it is welded
  EXPECT_EQ(splits({0.91, 0.0, 0}, 0.1), 0U);
  EXPECT_EQ(splits({1.2, 0.0, 0}, 0.1), 0U);
}

}  // namespace
}  // namespace prefilter
