// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/loop_caps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "wavelet/meshes.h"

namespace prefilter {
namespace {

using testing::Mesh;
using testing::sphere_mesh;

std::vector<std::uint32_t> all_of(std::size_t count) {
  std::vector<std::uint32_t> loop(count);
  std::iota(loop.begin(), loop.end(), 0U);
  return loop;
}

TEST(LoopCaps, FansMeetAtTheMeanOfTheLoop) {
  // The corners of a square, and many additional points along one side.
  std::vector<Vector3> positions = {{0, 0, 5}};
  for (int i = 1; i < 20; ++i) positions.push_back({i / 20.0, 0, 5});
  positions.insert(positions.end(), {{1, 0, 5}, {1, 1, 5}, {0, 1, 5}});
  const std::vector<std::uint32_t> loop = all_of(positions.size());
  const LoopCap cap = fan_over(positions, loop);
  ASSERT_EQ(cap.added.size(), 1U);
  EXPECT_NEAR(cap.added[0][0], 0.5, 1e-12);
  EXPECT_NEAR(cap.added[0][1], 0.5, 1e-12);
  EXPECT_NEAR(cap.added[0][2], 5.0, 1e-12);
  double area = 0.0;
  for (std::size_t t = 0; t < cap.triangles.size(); ++t) {
    const auto [a, b, c] = cap_corners(positions, loop, cap, t);
    area += cross(b - a, c - a)[2] / 2.0;
  }
  EXPECT_NEAR(area, 1.0, 1e-12);
  const LoopCap single = fan_over(positions, all_of(3));
  EXPECT_TRUE(single.added.empty());
  EXPECT_EQ(single.triangles.size(), 1U);
}

// Cap of a loop of this many edges at the north pole of a sphere.
LoopCap cap_of(const Mesh& mesh, HoleMethod method, bool is_smooth, std::size_t edges) {
  const InputMesh input{mesh.positions, mesh.triangles};
  const BorderLoops loops = border_loops(input, prefilter::Run(1));
  EXPECT_EQ(loops.size(), 1U);
  EXPECT_EQ(loops.loop(0).size(), edges);
  const std::vector<unsigned char> is_kept(1, 1);
  std::vector<LoopCap> caps = first_caps(input, loops, is_kept, method, prefilter::Run(1));
  if (is_smooth) smooth_caps(input, loops, is_kept, prefilter::Run(1), &caps);
  // Mesh and cap together are closed, and the cap has no other border.
  std::map<std::pair<Vector3, Vector3>, int> edges_of;
  const auto add = [&](const std::array<Vector3, 3>& p) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3& a = p[i];
      const Vector3& b = p[(i + 1) % 3];
      a < b ? ++edges_of[{a, b}] : --edges_of[{b, a}];
    }
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) add(input.corners(t));
  for (std::size_t t = 0; t < caps[0].triangles.size(); ++t) {
    add(cap_corners(input.positions, loops.loop(0), caps[0], t));
  }
  for (const auto& [edge, count] : edges_of) EXPECT_EQ(count, 0);
  // Appended after other caps, it is the same with shifted vertex numbers.
  Caps all;
  all.positions.resize(7);
  append_cap(mesh.positions.size(), loops.loop(0), caps[0], &all);
  for (std::size_t t = 0; t < all.triangles.size(); ++t) {
    const auto corners = cap_corners(input.positions, loops.loop(0), caps[0], t);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(all.triangles[t][k]);
      const std::size_t count = mesh.positions.size();
      EXPECT_EQ(v < count ? mesh.positions[v] : all.positions[v - count], corners[k]);
    }
  }
  return caps[0];
}

TEST(LoopCaps, MethodsAddNoneOneOrManyVertices) {
  for (const int rings : {12, 60}) {  // short loops, and long ones
    Mesh mesh = sphere_mesh({0, 0, 0}, 1.0, rings);
    const double low = std::cos(std::numbers::pi / 4.0 - 1e-9);
    std::erase_if(mesh.triangles, [&](const auto& t) {
      return std::any_of(t.begin(), t.end(), [&](auto v) {
        return mesh.positions[static_cast<std::size_t>(v)][2] > low + 1e-6;
      });
    });
    const auto edges = static_cast<std::size_t>(2 * rings);
    EXPECT_EQ(cap_of(mesh, HoleMethod::kFan, false, edges).triangles.size(), edges);
    const LoopCap flat = cap_of(mesh, HoleMethod::kFlat, false, edges);
    EXPECT_TRUE(flat.added.empty());
    EXPECT_EQ(flat.triangles.size(), edges - 2);
    const LoopCap smooth = cap_of(mesh, HoleMethod::kSmooth, true, edges);
    EXPECT_GT(smooth.added.size(), edges / 2);
    for (const Vector3& p : smooth.added) EXPECT_NEAR(length(p), 1.0, 0.04);
  }
}

}  // namespace
}  // namespace prefilter
