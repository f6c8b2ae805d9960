// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/fit_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

namespace prefilter {
namespace {

constexpr int kDepth = 5;
constexpr int kSide = 1 << kDepth;

struct Sample {
  Vector3 point;  // in cells
  Vector3 normal;
};

// The samples gathered into cells, in order of their keys.
SampleLevel level_of(const std::vector<Sample>& samples) {
  std::map<CellKey, SampleCell> cells;
  for (const Sample& sample : samples) {
    CellPosition at;
    for (std::size_t a = 0; a < 3; ++a) at[a] = static_cast<int>(std::floor(sample.point[a]));
    SampleCell& cell = cells[cell_key(at)];
    cell.key = cell_key(at);
    cell.weight += 1.0F;
    for (std::size_t a = 0; a < 3; ++a) {
      const double within = sample.point[a] - at[a];
      cell.normal[a] += static_cast<float>(sample.normal[a]);
      cell.position[a] += static_cast<float>(within);
      cell.flux[a] += static_cast<float>(within * sample.normal[a]);
    }
  }
  SampleLevel level;
  for (const auto& [key, cell] : cells) level.samples.cells.push_back(cell);
  return level;
}

SampleIndex index_of(const SampleLevel& level) {
  SampleIndex index(kDepth, 0, kSide);
  index.add(level);
  index.finish();
  return index;
}

Vector3 random_direction(std::mt19937* random) {
  std::normal_distribution<double> normal;
  Vector3 n = {normal(*random), normal(*random), normal(*random)};
  const double length = std::sqrt(dot(n, n));
  for (double& x : n) x /= length;
  return n;
}

TEST(LocalSurface, ReproducesAPlane) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform;
  int lines = 0;
  for (int round = 0; round < 10; ++round) {
    const Vector3 n = random_direction(&random);
    const Vector3 middle = {15.2, 16.7, 14.1};
    std::vector<Sample> samples;
    for (int i = 0; i < 4000; ++i) {
      Vector3 p;
      for (std::size_t a = 0; a < 3; ++a) p[a] = middle[a] + 10.0 * (uniform(random) - 0.5);
      const double height = dot(p - middle, n);
      for (std::size_t a = 0; a < 3; ++a) p[a] -= height * n[a];
      samples.push_back({p, n});
    }
    const SampleLevel level = level_of(samples);
    const SampleIndex index = index_of(level);
    for (const double trust : {1.0, 0.5, 0.0}) {
      for (const double distance : {0.0, 0.3, -0.2}) {
        Vector3 point;
        for (std::size_t a = 0; a < 3; ++a) point[a] = middle[a] + distance * n[a];
        const auto surface = local_surface(index, point, trust);
        if (!surface && trust == 0.0) {
          ++lines;
          continue;
        }
        ASSERT_TRUE(surface) << round << " " << trust << " " << distance;
        EXPECT_NEAR(surface->distance, distance, 1e-5);
        EXPECT_NEAR(dot(surface->normal, n), 1.0, 1e-6);
        EXPECT_GT(surface->weight, 1.0);
        EXPECT_LT(surface->weight, 4000.0);
      }
    }
  }
  // At most 2 of 30 queries find a line instead, where the plane runs along a row of cells.
  EXPECT_LE(lines, 2);
}

TEST(LocalSurface, ApproximatesASphere) {
  constexpr double kRadius = 12.0;
  const Vector3 middle = {16.1, 15.9, 16.2};
  std::mt19937 random(2);
  std::vector<Sample> samples;
  for (int i = 0; i < 60000; ++i) {
    const Vector3 n = random_direction(&random);
    samples.push_back(
        {{middle[0] + kRadius * n[0], middle[1] + kRadius * n[1], middle[2] + kRadius * n[2]}, n});
  }
  const SampleLevel level = level_of(samples);
  const SampleIndex index = index_of(level);
  constexpr int kCount = 200;
  double sum = 0.0;
  double sum_of_positions = 0.0;
  int found = 0;
  for (int i = 0; i < kCount; ++i) {
    const Vector3 n = random_direction(&random);
    const double distance = 0.25 * ((i % 3) - 1);
    Vector3 point;
    for (std::size_t a = 0; a < 3; ++a) point[a] = middle[a] + (kRadius + distance) * n[a];
    const auto surface = local_surface(index, point, 1.0);
    ASSERT_TRUE(surface);
    EXPECT_NEAR(surface->distance, distance, 0.02);
    EXPECT_GT(dot(surface->normal, n), 0.999);
    sum += surface->distance - distance;
    // Few cells are this close, and their mean positions may lie on a line.
    const auto of_positions = local_surface(index, point, 0.0);
    if (!of_positions) continue;
    sum_of_positions += of_positions->distance - distance;
    ++found;
  }
  EXPECT_GT(found, kCount * 3 / 4);
  // The plane fitted to mean positions, which lie inside the sphere, has the larger error.
  EXPECT_LT(std::abs(sum / kCount), 0.75 * std::abs(sum_of_positions / found)) << sum / kCount;
  EXPECT_NEAR(sum_of_positions / found, 1.0 / (8.0 * kRadius), 0.01);
}

TEST(LocalSurface, IsNoneWithoutSamplesOrDirection) {
  const SampleLevel none = level_of({});
  EXPECT_FALSE(local_surface(index_of(none), {3.0, 3.0, 3.0}, 1.0));
  const SampleLevel level =
      level_of({{{3.2, 3.3, 3.4}, {0.0, 0.0, 1.0}}, {{3.6, 3.3, 3.4}, {0.0, 0.0, -1.0}}});
  const SampleIndex index = index_of(level);
  EXPECT_FALSE(local_surface(index, {3.4, 3.3, 3.4}, 1.0));
  EXPECT_FALSE(local_surface(index, {9.0, 9.0, 9.0}, 1.0));
  EXPECT_FALSE(local_surface(index, {-50.0, 900.0, 3.0}, 0.0));
}

}  // namespace
}  // namespace prefilter
