// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/mesh_edges.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <utility>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

using EdgeTriangles = std::vector<std::array<std::int32_t, 3>>;

EdgeTriangles random_triangles(int vertices, int count, unsigned seed) {
  std::mt19937 random(seed);
  EdgeTriangles triangles(static_cast<std::size_t>(count));
  for (auto& triangle : triangles) {
    for (std::int32_t& corner : triangle) {
      corner = static_cast<std::int32_t>(random() % static_cast<unsigned>(vertices));
    }
  }
  return triangles;
}

// Reference implementation with an ordered map.
MeshEdges slow_edges(const EdgeTriangles& triangles) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> numbers;
  for (const auto& triangle : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(triangle[i], triangle[(i + 1) % 3]);
      if (low != high) numbers[{low, high}] = 0;
    }
  }
  MeshEdges edges;
  for (auto& [ends, number] : numbers) {
    number = static_cast<std::int32_t>(edges.vertices.size());
    edges.vertices.push_back({ends.first, ends.second});
  }
  for (const auto& triangle : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(triangle[i], triangle[(i + 1) % 3]);
      edges.of_corners.push_back(low == high ? -1 : numbers[{low, high}]);
    }
  }
  return edges;
}

TEST(MeshEdges, EqualThoseOfAMap) {
  for (const auto& [vertices, count] : {std::pair{3, 1}, {3, 40}, {40, 100}, {20'000, 40'000}}) {
    const EdgeTriangles triangles = random_triangles(vertices, count, 7);
    const std::vector<Vector3> positions(static_cast<std::size_t>(vertices));
    const MeshEdges expected = slow_edges(triangles);
    for (const int threads : {1, 3}) {
      const MeshEdges found = find_mesh_edges({positions, triangles}, prefilter::Run(threads));
      EXPECT_EQ(found.vertices, expected.vertices) << vertices;
      EXPECT_EQ(found.of_corners, expected.of_corners) << vertices;
    }
  }
}

TEST(MeshEdges, RefuseInvalidTriangles) {
  const std::vector<Vector3> positions(3);
  EXPECT_THROW(find_mesh_edges({positions, EdgeTriangles{}}, prefilter::Run(1)), Error);
  EXPECT_THROW(find_mesh_edges({positions, EdgeTriangles{{0, 1, 3}}}, prefilter::Run(1)), Error);
}

}  // namespace
}  // namespace prefilter
