// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/fill.h"

#include <gtest/gtest.h>

#include <array>

#include "wavelet/meshes.h"

namespace prefilter {
namespace {

using testing::box_mesh;
using testing::Mesh;
using testing::sphere_mesh;

double volume_of(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c])) / 6.0;
  }
  return sum;
}

// Volume inside a closed mesh, measured with cells of this side.
double filled_volume(const Mesh& mesh, double cell) {
  const MeshView<std::int32_t> view{mesh.positions, mesh.triangles};
  const ReachGrid grid(view, cell, 0.0, prefilter::Run(1));
  std::vector<bool> is_filled(grid.region_end(), false);
  for (std::size_t r = ReachGrid::kFirstRegion; r < is_filled.size(); ++r) is_filled[r] = true;
  return volume_of(filled_regions(view, grid, is_filled, prefilter::Run(1)));
}

TEST(FilledRegions, HaveTheVolumeOfTheMesh) {
  EXPECT_NEAR(filled_volume(box_mesh({0.013, 0.02, 0.04}, {1, 1, 1}), 0.05), 0.987 * 0.98 * 0.96,
              0.01);
  constexpr double kBall = 4.0 / 3.0 * 3.14159265358979;
  EXPECT_NEAR(filled_volume(sphere_mesh({0, 0, 0}, 1.0, 40), 0.08), kBall, 0.02 * kBall);
}

TEST(FilledRegions, DoNotDependOnOrientation) {
  Mesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  }
  EXPECT_NEAR(filled_volume(mesh, 0.05), 1.0, 0.02);
}

TEST(FilledRegions, IncludeInnerWalls) {
  Mesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  // A wall through the middle that leaves a wide gap.
  const auto first = static_cast<std::int32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(),
                        {{0.1, 0.1, 0.52}, {0.6, 0.1, 0.52}, {0.6, 0.9, 0.52}, {0.1, 0.9, 0.52}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  EXPECT_NEAR(filled_volume(mesh, 0.05), 1.0, 0.02);
}

}  // namespace
}  // namespace prefilter
