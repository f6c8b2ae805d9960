// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/close_holes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "prefilter/base/error.h"
#include "prefilter/voxels/queries.h"
#include "prefilter/voxels/voxelize.h"
#include "wavelet/meshes.h"

namespace prefilter {
namespace {

using testing::box_mesh;
using testing::Mesh;
using testing::sphere_mesh;
using Triangles = std::vector<std::array<std::int64_t, 3>>;

Triangles triangles_of(const Mesh& mesh) {
  Triangles triangles;
  for (const auto& t : mesh.triangles) triangles.push_back({t[0], t[1], t[2]});
  return triangles;
}

// Sum over all edges of the difference between the uses in each direction.
std::size_t imbalance(const std::vector<Vector3>& positions, const Triangles& triangles) {
  std::map<std::pair<Vector3, Vector3>, int> runs;
  for (const auto& t : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3& a = positions[static_cast<std::size_t>(t[i])];
      const Vector3& b = positions[static_cast<std::size_t>(t[(i + 1) % 3])];
      if (a == b) continue;
      a < b ? ++runs[{a, b}] : --runs[{b, a}];
    }
  }
  std::size_t sum = 0;
  for (const auto& [edge, count] : runs) sum += static_cast<std::size_t>(std::abs(count));
  return sum;
}

CloseHolesOptions with(HoleMethod method) {
  CloseHolesOptions options;
  options.method = method;
  options.run = prefilter::Run(1);
  return options;
}

struct Closed {
  std::vector<Vector3> positions;
  Triangles triangles;
  Caps caps;
};

Closed closed(const std::vector<Vector3>& positions, const Triangles& triangles,
              HoleMethod method = HoleMethod::kSmooth) {
  Closed result{positions, triangles, close_holes({positions, triangles}, with(method))};
  result.positions.insert(result.positions.end(), result.caps.positions.begin(),
                          result.caps.positions.end());
  result.triangles.insert(result.triangles.end(), result.caps.triangles.begin(),
                          result.caps.triangles.end());
  return result;
}

// All edges are paired, except along the loops that are left open.
void expect_pairs(const std::vector<Vector3>& positions, const Triangles& triangles,
                  const Closed& found) {
  EXPECT_EQ(imbalance(positions, triangles), imbalance(found.positions, found.caps.triangles) +
                                                 imbalance(found.positions, found.triangles));
  if (found.caps.left_open == 0) {
    EXPECT_EQ(imbalance(found.positions, found.triangles), 0U);
  }
}

TEST(CloseHoles, ClosedMeshesStay) {
  const Mesh mesh = sphere_mesh({0.5, 0.5, 0.5}, 0.4, 20);
  const Closed found = closed(mesh.positions, triangles_of(mesh));
  EXPECT_TRUE(found.caps.triangles.empty());
  EXPECT_EQ(found.caps.open_edges, 0U);
  EXPECT_EQ(found.caps.holes, 0U);
}

TEST(CloseHoles, SoupsAreWelded) {
  const Mesh mesh = sphere_mesh({0.5, 0.5, 0.5}, 0.4, 10);
  std::vector<Vector3> positions;
  Triangles triangles;
  for (const auto& t : mesh.triangles) {
    const auto first = static_cast<std::int64_t>(positions.size());
    for (const auto vertex : t)
      positions.push_back(mesh.positions[static_cast<std::size_t>(vertex)]);
    triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_TRUE(closed(positions, triangles).caps.triangles.empty());
}

TEST(CloseHoles, FlatHolesOfABoxAreClosedExactly) {
  Mesh mesh = box_mesh({0.2, 0.2, 0.2}, {0.7, 0.8, 0.6});
  mesh.triangles.erase(mesh.triangles.begin() + 4, mesh.triangles.begin() + 6);
  const Closed found = closed(mesh.positions, triangles_of(mesh));
  EXPECT_EQ(found.caps.open_edges, 4U);
  EXPECT_EQ(found.caps.holes, 1U);
  VoxelizeOptions options;
  options.depth = 5;
  const Octree octree = voxelize({found.positions, found.triangles}, options);
  EXPECT_NEAR(volume(octree), 0.5 * 0.6 * 0.4, 1e-6);
}

TEST(CloseHoles, EdgesAreInPairsForAnyHoles) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 30; ++trial) {
    const Mesh mesh = sphere_mesh({0.5, 0.5, 0.5}, 0.4, 12);
    Triangles triangles = triangles_of(mesh);
    std::shuffle(triangles.begin(), triangles.end(), random);
    triangles.resize(triangles.size() - static_cast<std::size_t>(trial) * 12U);
    if (trial % 3 == 1) {
      for (std::size_t t = 0; t < triangles.size(); t += 7)
        std::swap(triangles[t][0], triangles[t][1]);
    }
    if (trial % 3 == 2) {
      for (std::size_t t = 0; t < 20; ++t) triangles.push_back(triangles[t]);  // twice
    }
    for (const HoleMethod method : {HoleMethod::kSmooth, HoleMethod::kFlat, HoleMethod::kFan}) {
      const Closed found = closed(mesh.positions, triangles, method);
      EXPECT_LE(found.caps.left_open, found.caps.holes / (trial < 10 ? 4U : 1U)) << trial;
      expect_pairs(mesh.positions, triangles, found);
    }
  }
}

TEST(CloseHoles, EdgesAreInPairsForRandomSoups) {
  std::mt19937 random(2);
  std::uniform_int_distribution<std::int64_t> vertex(0, 19);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Vector3> positions;
  for (int i = 0; i < 20; ++i)
    positions.push_back({uniform(random), uniform(random), uniform(random)});
  for (int trial = 0; trial < 50; ++trial) {
    Triangles triangles;
    for (int t = 0; t < 30; ++t)
      triangles.push_back({vertex(random), vertex(random), vertex(random)});
    for (const HoleMethod method : {HoleMethod::kSmooth, HoleMethod::kFlat, HoleMethod::kFan}) {
      expect_pairs(positions, triangles, closed(positions, triangles, method));
    }
  }
}

TEST(CloseHoles, IsTheSameForAnyNumberOfThreads) {
  const Mesh mesh = sphere_mesh({0.5, 0.5, 0.5}, 0.4, 40);
  Triangles triangles = triangles_of(mesh);
  triangles.erase(triangles.begin(), triangles.begin() + 700);
  std::mt19937 random(3);
  std::shuffle(triangles.begin(), triangles.end(), random);
  triangles.resize(triangles.size() - 300);
  CloseHolesOptions options;
  options.run = prefilter::Run(1);
  const Caps one = close_holes({mesh.positions, triangles}, options);
  options.run = prefilter::Run(3);
  const Caps three = close_holes({mesh.positions, triangles}, options);
  EXPECT_EQ(one.positions, three.positions);
  EXPECT_EQ(one.triangles, three.triangles);
  EXPECT_GT(one.triangles.size(), 700U);
}

TEST(CloseHoles, DoesNotDependOnScaleOrPosition) {
  const Mesh mesh = sphere_mesh({0.0, 0.0, 0.0}, 1.0, 16);
  Triangles triangles = triangles_of(mesh);
  triangles.erase(triangles.begin(), triangles.begin() + 32 * 5);
  const std::size_t expected = closed(mesh.positions, triangles).triangles.size();
  for (const double scale : {0x1p-980, 0x1p-100, 0x1p100, 0x1p990}) {
    std::vector<Vector3> positions = mesh.positions;
    for (Vector3& p : positions) {
      for (double& x : p) x *= scale;
    }
    const Closed found = closed(positions, triangles);
    EXPECT_EQ(found.triangles.size(), expected);
    for (const Vector3& p : found.positions) EXPECT_LT(length(p), 1.04 * scale);
  }
}

TEST(CloseHoles, StopsWithinLongLoops) {
  constexpr int kCount = 20000;
  std::vector<Vector3> positions;
  Triangles triangles;
  for (int i = 0; i < kCount; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCount;
    const double wave = 0.1 * std::sin(5.0 * angle);
    positions.push_back({std::cos(angle), std::sin(angle), wave});
    triangles.push_back({i, kCount, (i + 1) % kCount});
  }
  positions.push_back({0.0, 0.0, -2.0});
  int calls = 0;
  CloseHolesOptions options;
  options.run = prefilter::Run(1, [&](double) { return ++calls < 6; });
  EXPECT_THROW(close_holes({positions, triangles}, options), Error);
  EXPECT_EQ(calls, 6);
}

}  // namespace
}  // namespace prefilter
