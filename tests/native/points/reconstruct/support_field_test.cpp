// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/support_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "points/reconstruct/test_cloud.h"
#include "prefilter/points/reconstruct/coarse_tree.h"
#include "prefilter/points/reconstruct/slabs.h"
#include "prefilter/points/reconstruct/whole_samples.h"

namespace prefilter {
namespace {

constexpr int kDepth = 6;
constexpr int kTop = 3;

class Leaves {
 public:
  explicit Leaves(testing::TestCloud points)
      : cloud(std::move(points)),
        store(cloud, kDepth, kDepth - kTop),
        slabs(&store, kDepth, kTop, 0, true, 1) {
    compute_whole_samples(0, prefilter::Run(1), &slabs);
    slabs.advance_to(0, slabs.count(), SlabStage::kLeaves);
  }
  // Distance from the nearest point, in finest cells.
  double distance(const Vector3& p) const {
    double least = 1e9;
    for (const Vector3& q : cloud.points) least = std::min(least, length(64.0 * q - p));
    return least;
  }

  testing::TestCloud cloud;
  testing::CloudStore store;
  Slabs slabs;
};

// Distances in cells as large as the spacing of the samples or larger.
TEST(SupportField, MeasuresDistancesFromSamples) {
  const Leaves leaves(testing::sphere_cloud(20000));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 64.0);
  for (const int s : {1, 3, 6}) {
    SupportField field(leaves.slabs, 1.0, s);
    for (int i = 0; i < 400; ++i) {
      const Vector3 p = {uniform(random), uniform(random), 8.0 * s + uniform(random) / 8.0};
      const double expected = leaves.distance(p);
      const auto found = static_cast<double>(field.at({p, {}}, kDepth).distance);
      EXPECT_NEAR(found, expected, 1.0 + 0.25 * expected);
    }
  }
}

TEST(SupportField, IsInUnitsOfTheSampleSpacing) {
  // The upper half has a sixteenth of the density.
  const Leaves leaves(testing::uneven_sphere_cloud());
  SupportField low(leaves.slabs, 1.0, 1);
  SupportField high(leaves.slabs, 1.0, 6);
  const auto at = [](double height, double away) {
    const double z = height - 32.0;
    const double radius = std::sqrt(22.4 * 22.4 - z * z);
    return OrientedPoint{{32.0 + radius + away, 32.0, height}, {1.0, 0.0, 0.0}};
  };
  const Support dense = low.at(at(13.0, 4.0), kDepth);
  const Support thin = high.at(at(50.0, 4.0), kDepth);
  EXPECT_GT(dense.distance, 2.0F);
  EXPECT_LT(thin.distance, 0.7F * dense.distance);
  EXPECT_NEAR(thin.spacing / dense.spacing, 4.0F, 1.2F);
  const double per_point = 4.0 * 3.14159265 * 22.4 * 22.4 / 20000.0;
  EXPECT_NEAR(static_cast<double>(dense.spacing), std::sqrt(per_point), 0.1);
}

TEST(SupportField, SamplesSupportSurfacesWithTheirNormal) {
  const Leaves leaves(testing::sphere_cloud(20000));
  for (const double sign : {1.0, -1.0}) {
    SupportField field(leaves.slabs, sign, 3);
    const Vector3 p = {32.0 + 22.4, 32.0, 30.0};
    EXPECT_LT(field.at({p, {sign, 0.0, 0.0}}, kDepth).distance, 1.0F);
    // A sharp edge turns the normal this far; a region this close to samples is not cut.
    EXPECT_LT(field.at({p, {0.0, 1.0, 0.0}}, kDepth).distance, 2.0F);
    EXPECT_GE(field.at({p, {-sign, 0.0, 0.0}}, kDepth).distance, 4.0F);
  }
}

TEST(SupportField, DistanceGrowsWithTheAngleOfNormals) {
  const Leaves leaves(testing::sphere_cloud(20000));
  SupportField field(leaves.slabs, 1.0, 3);
  const auto at_angle = [&](double away, double degrees) {
    const double angle = degrees * 3.14159265358979 / 180.0;
    const Vector3 p = {32.0 + 22.4 + away, 32.0, 30.0};
    return field.at({p, {std::cos(angle), std::sin(angle), 0.0}}, kDepth).distance;
  };
  const float facing = at_angle(1.0, 0.0);
  EXPECT_EQ(at_angle(1.0, 30.0), facing);
  // Factors from the cosines: 1 + 2 * (0.7 - 0.5), and 1 + 2 * 0.7. Neighboring samples may reduce
  // them.
  EXPECT_NEAR(at_angle(1.0, 60.0), 1.4F * facing, 0.1F * facing);
  EXPECT_NEAR(at_angle(1.0, 90.0), 2.4F * facing, 0.3F * facing);
  // Angles do not add to distances that are cut anyway.
  EXPECT_EQ(at_angle(3.2, 90.0), at_angle(3.2, 0.0));
}

TEST(SupportField, OutliersSupportNothing) {
  const Leaves leaves(testing::stray_cloud());
  SupportField field(leaves.slabs, 1.0, 0);
  EXPECT_GE(field.at({{32.0, 3.2, 1.3}, {0.0, 0.0, 1.0}}, kDepth).distance, 4.0F);
}

}  // namespace
}  // namespace prefilter
