// SPDX-License-Identifier: GPL-3.0-or-later

// Operations on shapes can be canceled at any time: measures the longest time between two progress
// reports, in seconds of processor time, which does not depend on the machine's load.
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <functional>
#include <numbers>

#include "prefilter/geometry/nearest.h"
#include "prefilter/voxels/close_holes.h"
#include "prefilter/voxels/combine.h"
#include "prefilter/voxels/tree_contour.h"
#include "prefilter/voxels/voxelize.h"
#include "wavelet/meshes.h"

namespace prefilter {
namespace {

// Seconds; 0.2 are promised.
constexpr double kLongest = 0.15;

double processor_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Longest time without a report by `work`, in seconds.
double longest_gap(const std::function<void(const prefilter::Run&)>& work) {
  double longest = 0.0;
  double last = processor_seconds();
  const auto note = [&] {
    const double now = processor_seconds();
    longest = std::max(longest, now - last);
    last = now;
  };
  work(prefilter::Run([&](double) {
    note();
    return true;
  }));
  note();
  return longest;
}

class ReportGaps : public ::testing::Test {
 protected:
  static constexpr int kDepth = 8;

#ifdef __SANITIZE_ADDRESS__
  static constexpr bool kIsSlowed = true;
#else
  static constexpr bool kIsSlowed = false;
#endif

  void SetUp() override {
    if (kIsSlowed) GTEST_SKIP() << "sanitizers take most of the time";
  }
  static void SetUpTestSuite() {
    if (kIsSlowed) return;
    mesh = testing::sphere_mesh({0.5, 0.5, 0.5}, 0.4, 450);
    for (const auto& t : mesh.triangles) triangles.push_back({t[0], t[1], t[2]});
    sphere = voxelize(input(), options(prefilter::Run()));
    other = voxelize(input(), options(prefilter::Run(), 0.01));
  }
  static void TearDownTestSuite() {
    mesh = {};
    triangles = {};
    sphere = {};
    other = {};
  }

  static InputMesh input() { return {mesh.positions, triangles}; }
  static VoxelizeOptions options(const prefilter::Run& run, double offset = 0.0) {
    VoxelizeOptions result;
    result.depth = kDepth;
    result.bounds = Box{{offset, offset, offset}, {offset + 1.0, offset + 1.0, offset + 1.0}};
    result.run = run.with_threads(1);
    return result;
  }

  static inline testing::Mesh mesh;
  static inline std::vector<std::array<std::int64_t, 3>> triangles;
  static inline Octree sphere;
  static inline Octree other;
};

TEST_F(ReportGaps, OfVoxelize) {
  EXPECT_LT(longest_gap([](const prefilter::Run& run) { voxelize(input(), options(run)); }),
            kLongest);
}

TEST_F(ReportGaps, OfContoursAndCleanUp) {
  for (const Interpolant interpolant : {Interpolant::kOccupancy, Interpolant::kPlane}) {
    ContourOptions contour;
    contour.interpolant = interpolant;
    contour.clean_up = true;
    contour.run = prefilter::Run(1);
    const double gap = longest_gap([&](const prefilter::Run& run) {
      contour.run = run;
      contour_tree(sphere.cells, sphere.bounds, contour);
    });
    EXPECT_LT(gap, kLongest);
  }
}

TEST_F(ReportGaps, OfSetOperations) {
  EXPECT_LT(longest_gap([](const prefilter::Run& run) {
              combine(sphere, other, SetOperation::kUnion, run.with_threads(1));
            }),
            kLongest);
}

TEST_F(ReportGaps, OfHoles) {
  const std::span<const std::array<std::int64_t, 3>> all = triangles;
  EXPECT_LT(longest_gap([&](const prefilter::Run& run) {
              CloseHolesOptions holes;
              holes.run = run.with_threads(1);
              close_holes({mesh.positions, all.subspan(0, all.size() - 7)}, holes);
            }),
            kLongest);
}

TEST_F(ReportGaps, OfALongHole) {
  // A cone with a wavy border of so many edges that its patch is as large as patches get.
  constexpr int kCount = 400;
  std::vector<Vector3> positions;
  std::vector<std::array<std::int64_t, 3>> faces;
  for (int i = 0; i < kCount; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCount;
    positions.push_back({std::cos(angle), std::sin(angle), 0.1 * std::sin(5.0 * angle)});
    faces.push_back({i, kCount, (i + 1) % kCount});
  }
  positions.push_back({0.0, 0.0, 2.0});
  for (auto& face : faces) std::swap(face[1], face[2]);
  for (auto& position : positions) position[2] *= -0.5;
  EXPECT_LT(longest_gap([&](const prefilter::Run& run) {
              CloseHolesOptions holes;
              holes.run = run.with_threads(1);
              EXPECT_GT(close_holes({positions, faces}, holes).triangles.size(), 10000U);
            }),
            kLongest);
}

TEST_F(ReportGaps, OfNearestPoints) {
  EXPECT_LT(longest_gap([](const prefilter::Run& run) {
              nearest_points(std::span(mesh.positions).subspan(0, 50000), input(),
                             run.with_threads(1));
            }),
            kLongest);
}

}  // namespace
}  // namespace prefilter
