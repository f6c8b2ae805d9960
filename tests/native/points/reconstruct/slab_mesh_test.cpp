// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/slab_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <tuple>
#include <utility>

#include "points/reconstruct/test_cloud.h"
#include "prefilter/points/reconstruct/coarse_tree.h"
#include "prefilter/points/reconstruct/whole_samples.h"

namespace prefilter {
namespace {

constexpr int kDepth = 6;
constexpr int kTop = 3;

// A sphere's samples in slabs, with the leaves of all slabs computed.
class Sphere {
 public:
  explicit Sphere(testing::TestCloud points = testing::sphere_cloud(5000))
      : cloud(std::move(points)),
        store(cloud, kDepth, kDepth - kTop),
        slabs(&store, kDepth, kTop, 0, true, 1) {
    largest = compute_whole_samples(0, prefilter::Run(1), &slabs);
    build_coarse_tree(prefilter::Run(1), &slabs);
    slabs.advance_to(0, slabs.count(), SlabStage::kValues);
  }

  testing::TestCloud cloud;
  testing::CloudStore store;
  Slabs slabs;
  int largest;
};

TEST(SlabMesh, SamplesAroundASlabIncludeTheMargin) {
  const Sphere sphere;
  for (const int s : {0, 3, 7}) {
    for (const int k : {2, 3, 4, 6}) {
      constexpr int kMargin = 3;
      const SampleIndex index = samples_around(sphere.slabs, s, k, kMargin);
      const int height = k < kTop ? 1 << k : 1 << (k - kTop);
      int low = s * height - kMargin;
      int high = (s + 1) * height + kMargin;
      if (k < kTop) low = 0, high = 1 << k;
      // Only neighboring slabs contribute.
      if (k >= kTop) low = std::max(low, (s - 1) * height), high = std::min(high, (s + 2) * height);
      std::set<std::tuple<int, int, int>> expected;
      for (const Vector3& p : sphere.cloud.points) {
        const double side = std::ldexp(1.0, k);
        const auto x = static_cast<int>(p[0] * side);
        const auto y = static_cast<int>(p[1] * side);
        const auto z = static_cast<int>(p[2] * side);
        if (z >= low && z < high) expected.insert({x, y, z});
      }
      std::set<std::tuple<int, int, int>> found;
      const double middle = std::ldexp(0.5, k);
      index.for_near({middle, middle, middle}, 1 << k,
                     [&](const SampleCells& cells, std::size_t i, const Vector3& corner) {
                       const CellPosition at = cell_position(cells.cells[i].key);
                       EXPECT_EQ((Vector3{1.0 * at[0], 1.0 * at[1], 1.0 * at[2]}), corner);
                       found.insert({at[0], at[1], at[2]});
                     });
      EXPECT_EQ(found, expected) << s << " " << k;
    }
  }
}

// Vertices at random places are marked if they are farther from all points than the limit, up to
// the distance between points and the mean of their cell.
TEST(SlabMesh, MarksVerticesFarFromAllSamples) {
  const Sphere sphere;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 64.0);
  const int s = 3;
  for (const double limit : {0.5, 1.5, 4.0, 7.9, 12.0, 40.0}) {
    SlabMesh slab;
    for (int i = 0; i < 500; ++i) {
      const double z = (s + uniform(random) / 64.0) * 8.0;
      slab.contour.mesh.positions.push_back({uniform(random), uniform(random), z});
    }
    mark_far_vertices(sphere.slabs, s, limit, &slab);
    ASSERT_EQ(slab.is_trimmed.size(), 500U);
    int near = 0;
    for (std::size_t v = 0; v < slab.is_trimmed.size(); ++v) {
      double least = 1e9;
      for (const Vector3& p : sphere.cloud.points) {
        const Vector3 offset = {64.0 * p[0] - slab.contour.mesh.positions[v][0],
                                64.0 * p[1] - slab.contour.mesh.positions[v][1],
                                64.0 * p[2] - slab.contour.mesh.positions[v][2]};
        least = std::min(least, length(offset));
      }
      // Cells of the samples have a side of up to a quarter of the limit.
      const double margin = 1.8 * std::max(1.0, limit / 4.0);
      if (std::abs(least - limit) > margin) {
        EXPECT_EQ(slab.is_trimmed[v], least > limit ? 1 : 0) << limit << " " << least;
      }
      near += slab.is_trimmed[v] == 0 ? 1 : 0;
    }
    EXPECT_TRUE(near > 0 || limit < 1.0) << limit;
  }
}

TEST(SlabMesh, EstimatesTheNoiseOfSamples) {
  testing::TestCloud cloud = testing::sphere_cloud(8000);
  std::mt19937 random(3);
  constexpr double kNoise = 0.3;  // cells
  std::normal_distribution<double> normal(0.0, kNoise / 64.0);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const double height = normal(random);
    for (std::size_t a = 0; a < 3; ++a) cloud.points[i][a] += height * cloud.normals[i][a];
  }
  testing::CloudStore store(cloud, kDepth, kDepth - kTop);
  Slabs slabs(&store, kDepth, kTop, 0, true, 1);
  const int largest = compute_whole_samples(0, prefilter::Run(1), &slabs);
  EXPECT_NEAR(find_noise(largest, &slabs).distance, kNoise, 0.3 * kNoise);
}

TEST(SlabMesh, IsThePartOfTheSurfaceInTheSlab) {
  Sphere sphere(testing::sphere_cloud(20000));
  ReconstructOptions options;
  options.depth = kDepth;
  options.watertight = true;
  const SurfaceSamples surface = {sphere.slabs, 0, find_noise(sphere.largest, &sphere.slabs)};
  const SurfaceLevel level = find_surface_level(options, false, prefilter::Run(), &sphere.slabs);
  std::size_t vertices = 0;
  for (int s = 0; s < sphere.slabs.count(); ++s) {
    const SlabMesh slab = mesh_of_slab(surface, options, level, s);
    EXPECT_TRUE(slab.is_trimmed.empty());
    EXPECT_TRUE(slab.attributes.empty());
    vertices += slab.contour.mesh.positions.size();
    for (const Vector3& p : slab.contour.mesh.positions) {
      EXPECT_NEAR(length(Vector3{p[0] - 32.0, p[1] - 32.0, p[2] - 32.0}), 0.35 * 64.0, 0.1);
      EXPECT_GT(p[2], 8.0 * s - 3.0);
      EXPECT_LT(p[2], 8.0 * (s + 1) + 3.0);
    }
  }
  EXPECT_GT(vertices, 5000U);
}

// Mean distance of the vertices from the center of the sphere, in cells.
double mean_radius(const Sphere& sphere, const ReconstructOptions& options,
                   const SurfaceLevel& level) {
  const SurfaceSamples surface = {sphere.slabs, 0, {}};
  double sum = 0.0;
  double count = 0.0;
  for (int s = 0; s < sphere.slabs.count(); ++s) {
    for (const Vector3& p : mesh_of_slab(surface, options, level, s).contour.mesh.positions) {
      sum += length(Vector3{p[0] - 32.0, p[1] - 32.0, p[2] - 32.0});
      count += 1.0;
    }
  }
  return sum / count;
}

TEST(SlabMesh, GrowsAsTheLevelFalls) {
  const Sphere sphere(testing::sphere_cloud(20000));
  for (const bool smooth : {false, true}) {
    ReconstructOptions options;
    options.fit = false;
    options.smooth = smooth;
    const double low = mean_radius(sphere, options, {1.0F, 0.4F});
    const double middle = mean_radius(sphere, options, {1.0F, 0.5F});
    const double high = mean_radius(sphere, options, {1.0F, 0.6F});
    EXPECT_GT(low, middle + 0.05) << smooth;
    EXPECT_GT(middle, high + 0.05) << smooth;
    // Changing the scale has the same effect as changing the level.
    if (smooth) {
      EXPECT_NEAR(mean_radius(sphere, options, {1.25F, 0.5F}), low, 1e-3);
    }
  }
}

TEST(SlabMesh, FollowsSparseSamplesToo) {
  const Sphere sphere(testing::uneven_sphere_cloud());
  const SurfaceSamples surface = {sphere.slabs, 0, {}};
  const ReconstructOptions options;
  double error = 0.0;
  double count = 0.0;
  for (int s = 5; s < sphere.slabs.count(); ++s) {
    const SlabMesh slab = mesh_of_slab(surface, options, SurfaceLevel(), s);
    for (const Vector3& p : slab.contour.mesh.positions) {
      error += std::abs(length(Vector3{p[0] - 32.0, p[1] - 32.0, p[2] - 32.0}) - 0.35 * 64.0);
    }
    count += static_cast<double>(slab.contour.mesh.positions.size());
  }
  EXPECT_GT(count, 500.0);               // in cells as large as there are samples for
  EXPECT_LT(error, 0.05 * 2.0 * count);  // of their sides
}

}  // namespace
}  // namespace prefilter
