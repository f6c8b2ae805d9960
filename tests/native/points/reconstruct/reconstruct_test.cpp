// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/points/array_sink.h"
#include "prefilter/points/array_source.h"
#include "voxels/contour/mesh_checks.h"

namespace prefilter {
namespace {

struct Cloud {
  std::vector<Vector3> points;
  std::vector<Vector3> normals;
  std::vector<float> weights;
  std::vector<float> attributes;  // one

  ArraySource source() const {
    std::vector<PointAttribute> names;
    if (!attributes.empty()) names.push_back({"height", false});
    return {points, normals, weights, attributes, names};
  }
};

Cloud ball(int count) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  Cloud cloud;
  for (int i = 0; i < count; ++i) {
    Vector3 n = {normal(random), normal(random), normal(random)};
    const double size = length(n);
    for (double& x : n) x /= size;
    cloud.points.push_back(n);
    cloud.normals.push_back(n);
    cloud.weights.push_back(1.0F);
    cloud.attributes.push_back(static_cast<float>(n[2]));
  }
  return cloud;
}

struct Result {
  TriangleMesh mesh;
  std::vector<float> attributes;
  ReconstructReport report;
};

Result surface_of(const Cloud& cloud, const ReconstructOptions& options) {
  ArraySource source = cloud.source();
  ArraySink sink;
  Result result;
  result.report = reconstruct(&source, options, &sink);
  result.mesh = {sink.take_positions(), sink.take_triangles()};
  result.attributes = sink.take_attributes();
  return result;
}

void add(const Vector3& point, Cloud* cloud) {
  cloud->points.push_back(point);
  cloud->normals.push_back({0.0, 0.0, 1.0});
  cloud->weights.push_back(1.0F);
  cloud->attributes.push_back(0.0F);
}

// A few points far away change only the report.
TEST(Reconstruct, ExcludesFarOutliers) {
  Cloud near = ball(5000);
  for (Vector3& p : near.points) p = p + Vector3{4e5, 5e6, 100.0};
  for (const WaveletBasis basis : {WaveletBasis::kHaar, WaveletBasis::kD4}) {
    ReconstructOptions options;
    options.basis = basis;
    options.depth = 5;
    const Result wanted = surface_of(near, options);
    EXPECT_EQ(wanted.report.strays, 0U);
    const std::vector<std::vector<Vector3>> cases = {
        {{4e5, 5e6 - 20.0, 100.0}},
        {{0.0, 0.0, 0.0}},
        {{0.0, 0.0, 0.0}, {4e5, 5e6 - 2000.0, 100.0}, {4e5, 5e6, 107.0}},
        {{4e5 + 1e200, 5e6, 100.0}}};
    for (const std::vector<Vector3>& strays : cases) {
      Cloud cloud = near;
      for (const Vector3& p : strays) add(p, &cloud);
      for (const int threads : {1, 3}) {
        options.run = prefilter::Run(threads);
        const Result found = surface_of(cloud, options);
        // Huge coordinates are counted separately.
        const std::size_t huge = strays[0][0] > 1e30 ? 1 : 0;
        EXPECT_EQ(found.report.dropped.huge, huge);
        EXPECT_EQ(found.report.strays + huge, strays.size()) << strays[0][1];
        EXPECT_EQ(found.report.points, near.points.size() + strays.size());
        EXPECT_EQ(found.report.dropped.sum(), huge);
        EXPECT_EQ(found.mesh.positions, wanted.mesh.positions);
        EXPECT_EQ(found.mesh.triangles, wanted.mesh.triangles);
        EXPECT_EQ(found.attributes, wanted.attributes);
      }
    }
  }
}

TEST(Reconstruct, OutliersAreFewAndFar) {
  ReconstructOptions options;
  options.depth = 4;
  const auto strays_with = [&](int count, double distance, int more) {
    Cloud cloud = ball(count);
    for (int i = 0; i < more; ++i) add({distance, 0.01 * i, 0.0}, &cloud);
    return surface_of(cloud, options).report.strays;
  };
  EXPECT_EQ(strays_with(5000, 8.0, 3), 3U);
  EXPECT_EQ(strays_with(5000, 8.0, 4), 0U);
  EXPECT_EQ(strays_with(5000, 1.8, 1), 0U);
  EXPECT_EQ(strays_with(1500, 8.0, 1), 1U);
  EXPECT_EQ(strays_with(1500, 8.0, 2), 0U);
  EXPECT_EQ(strays_with(900, 100.0, 1), 0U);
  EXPECT_EQ(strays_with(500'000, 8.0, 5), 5U);
  EXPECT_EQ(strays_with(500'000, 8.0, 6), 0U);
  // A tail of points, each less than twice as far out as the one before, has no outliers.
  Cloud cloud = ball(5000);
  for (double distance = 1.5; distance < 10.0; distance *= 1.5) add({0.0, distance, 0.0}, &cloud);
  EXPECT_EQ(surface_of(cloud, options).report.strays, 0U);
}

TEST(Reconstruct, BallIsClosedAndAccurate) {
  const Cloud cloud = ball(10000);
  for (const WaveletBasis basis : {WaveletBasis::kHaar, WaveletBasis::kD4}) {
    for (const int depth : {1, 4, 6}) {
      for (const bool smooth : {true, false}) {
        ReconstructOptions options;
        options.basis = basis;
        options.depth = depth;
        options.smooth = smooth;
        options.memory_limit = smooth ? std::numeric_limits<std::uint64_t>::max() : 0;
        options.run = prefilter::Run(smooth ? 1 : 2);
        const Result result = surface_of(cloud, options);
        ASSERT_EQ(testing::fault_of(result.mesh), "");
        if (depth == 1) continue;
        EXPECT_NEAR(testing::volume_of(result.mesh), 4.0 / 3.0 * 3.14159265, 0.15);
        for (std::size_t v = 0; v < result.mesh.positions.size(); ++v) {
          const Vector3& p = result.mesh.positions[v];
          EXPECT_NEAR(length(p), 1.0, 0.1);
          EXPECT_NEAR(static_cast<double>(result.attributes[v]), p[2], 0.25);
        }
      }
    }
  }
}

TEST(Reconstruct, ReportsTheShareOfOutliers) {
  Cloud cloud = ball(20000);
  for (const double x : {-2.0, 0.0, 2.0}) {
    cloud.points.push_back({x, 2.0, 2.0});
    cloud.normals.push_back({0.0, 0.0, 1.0});
    cloud.weights.push_back(2.0F);
    cloud.attributes.push_back(0.0F);
  }
  ReconstructOptions options;
  options.depth = 7;
  for (const WaveletBasis basis : {WaveletBasis::kHaar, WaveletBasis::kD4}) {
    options.basis = basis;
    EXPECT_NEAR(surface_of(cloud, options).report.outliers, 6.0 / 20006.0, 1e-9);
  }
}

TEST(Reconstruct, FlipsNormalsThatMayPointInward) {
  Cloud cloud = ball(5000);
  for (Vector3& normal : cloud.normals) normal = Vector3{} - normal;
  ReconstructOptions options;
  options.depth = 5;
  for (const WaveletBasis basis : {WaveletBasis::kHaar, WaveletBasis::kD4}) {
    options.basis = basis;
    options.are_sides_known = false;
    EXPECT_TRUE(surface_of(cloud, options).report.is_flipped);
    options.are_sides_known = true;
    const Result kept = surface_of(cloud, options);
    EXPECT_FALSE(kept.report.is_flipped);
    EXPECT_TRUE(kept.report.is_room);
    EXPECT_NEAR(testing::volume_of(kept.mesh), -4.0 / 3.0 * 3.14159265, 0.15);
    const Result outside = surface_of(ball(5000), options);
    EXPECT_FALSE(outside.report.is_flipped);
    EXPECT_FALSE(outside.report.is_room);
  }
}

TEST(Reconstruct, CellsAreTheLargestAllowed) {
  const Cloud cloud = ball(1000);
  for (int depth = 2; depth < 7; ++depth) {
    ReconstructOptions options;
    options.depth = depth;
    const double cell = surface_of(cloud, options).report.cell;
    options.depth = 1;  // does not count
    // A size that is smaller by no more than rounding in single precision gives the same cells.
    for (const double size : {cell, (1.0 - 5e-7) * cell, 1.9 * cell}) {
      options.cell_size = size;
      EXPECT_EQ(surface_of(cloud, options).report.cell, cell) << depth;
    }
    options.cell_size = (1.0 - 1e-5) * cell;
    EXPECT_LT(surface_of(cloud, options).report.cell, 0.6 * cell) << depth;
  }
}

TEST(Reconstruct, RefusesCellsThatAreTooSmall) {
  const Cloud cloud = ball(1000);
  ReconstructOptions options;
  const auto message = [&](double size) {
    options.cell_size = size;
    try {
      surface_of(cloud, options);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const double size : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(message(size).starts_with("cell_size: ")) << size;
  }
  const std::string least = message(1e-6);
  const std::string use = "use ";
  ASSERT_NE(least.find(use), std::string::npos);
  // The length suggested by the message is accepted.
  EXPECT_EQ(message(std::stod(least.substr(least.find(use) + use.size()))), "");
}

TEST(Reconstruct, RefusesValuesOutOfRange) {
  const Cloud cloud = ball(100);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto message = [&](const ReconstructOptions& options, const Cloud& points) {
    try {
      surface_of(points, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      return std::string(error.what());
    }
    return std::string();
  };
  for (const int depth : {0, 13}) {
    ReconstructOptions options;
    options.depth = depth;
    EXPECT_TRUE(message(options, cloud).starts_with("depth: " + std::to_string(depth)));
  }
  for (const double number : {nan, infinity, -infinity, 1e300}) {
    ReconstructOptions options;
    options.isovalue = Isovalue::kGiven;
    options.given_isovalue = number;
    EXPECT_TRUE(message(options, cloud).starts_with("isovalue: "));
  }
  for (const double number : {nan, infinity, 0.0, -1.0, 1e300}) {
    ReconstructOptions options;
    options.trim = number;
    EXPECT_TRUE(message(options, cloud).starts_with("trim: "));
  }
  for (const double scale : {nan, infinity, 0.0, 1e301}) {
    Cloud scaled = cloud;
    for (Vector3& p : scaled.points) {
      for (double& x : p) x *= scale;
    }
    EXPECT_TRUE(message({}, scaled).starts_with("points: "));
  }
  EXPECT_TRUE(message({}, {}).starts_with("points: none"));
}

TEST(Reconstruct, IsFiniteForDegeneratePoints) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform;
  for (const Vector3& size :
       {Vector3{1.0, 0.0, 0.0}, Vector3{1.0, 1.0, 0.0}, Vector3{1.0, 1.0, 1.0},
        Vector3{1e-200, 0.0, 1e-200}, Vector3{0.0, 1e299, 1e299}}) {
    Cloud cloud;
    for (int i = 0; i < 500; ++i) {
      cloud.points.push_back(
          {size[0] * uniform(random), size[1] * uniform(random), size[2] * uniform(random)});
      cloud.normals.push_back({uniform(random) - 0.5, uniform(random) - 0.5, 1e-30});
    }
    for (const WaveletBasis basis : {WaveletBasis::kHaar, WaveletBasis::kD4}) {
      ReconstructOptions options;
      options.basis = basis;
      options.depth = 6;
      Result result;
      try {
        result = surface_of(cloud, options);
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find("normals: they contradict"), 0U) << error.what();
        continue;
      }
      for (const Vector3& p : result.mesh.positions) {
        for (const double x : p) ASSERT_TRUE(std::isfinite(x));
      }
      options.trim = 2.0;
      try {
        EXPECT_LE(surface_of(cloud, options).mesh.triangles.size(), result.mesh.triangles.size());
      } catch (const Error& error) {
        // Trimming may remove the whole surface.
        EXPECT_EQ(std::string(error.what()).find("trim: 2 cells"), 0U) << error.what();
      }
    }
  }
}

TEST(Reconstruct, CanBeStoppedAtAnyReport) {
  const Cloud cloud = ball(3000);
  for (const WaveletBasis basis : {WaveletBasis::kHaar, WaveletBasis::kD4}) {
    ReconstructOptions options;
    options.basis = basis;
    options.depth = 7;
    options.run = prefilter::Run(1);
    for (const double stop : {0.0, 0.1, 0.3, 0.5, 0.7, 0.9}) {
      options.run = prefilter::Run([stop](double fraction) { return fraction <= stop; });
      EXPECT_THROW(surface_of(cloud, options), Error) << stop;
    }
  }
}

}  // namespace
}  // namespace prefilter
