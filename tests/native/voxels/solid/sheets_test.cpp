// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/sheets.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "prefilter/voxels/solid/cap_losses.h"
#include "wavelet/meshes.h"

namespace prefilter {
namespace {

using testing::box_mesh;
using testing::Mesh;
using testing::sphere_mesh;

// A box without its top.
Mesh open_box(const Vector3& low, const Vector3& high) {
  Mesh mesh = box_mesh(low, high);
  mesh.triangles.erase(mesh.triangles.begin() + 2, mesh.triangles.begin() + 4);
  return mesh;
}

Mesh turned(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

// A flat grid of 100 x 100 squares without `hole` x `hole` of them in the middle.
Mesh sheet_with_hole(int hole) {
  constexpr int kSide = 100;
  Mesh mesh;
  for (int y = 0; y <= kSide; ++y) {
    for (int x = 0; x <= kSide; ++x) mesh.positions.push_back({x / 100.0, y / 100.0, 0.0});
  }
  const int low = (kSide - hole) / 2;
  const auto is_hole = [&](int i) { return i >= low && i < low + hole; };
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      if (is_hole(x) && is_hole(y)) continue;
      const int v = y * (kSide + 1) + x;
      mesh.triangles.push_back({v, v + 1, v + kSide + 2});
      mesh.triangles.push_back({v, v + kSide + 2, v + kSide + 1});
    }
  }
  return mesh;
}

struct Closing {
  explicit Closing(Mesh closed)
      : mesh(std::move(closed)),
        input{mesh.positions, mesh.triangles},
        loops(border_loops(input, prefilter::Run(1))),
        is_kept(loops.size(), 1),
        caps(first_caps(input, loops, is_kept, HoleMethod::kFan, prefilter::Run(1))),
        solids(drop_sheet_loops(input, loops, caps, prefilter::Run(), is_kept)) {}
  void drop_canceling_caps() {
    prefilter::drop_canceling_caps(input, loops, caps, solids, prefilter::Run(1), is_kept);
  }
  std::size_t kept() const {
    return static_cast<std::size_t>(std::count(is_kept.begin(), is_kept.end(), 1));
  }

  Closing(const Closing&) = delete;

  Mesh mesh;
  InputMesh input;
  BorderLoops loops;
  std::vector<unsigned char> is_kept;
  std::vector<LoopCap> caps;
  CappedSolids solids;
};

// A square box of height h has a volume of h, an area of 1 + 4 h and a cap of 1: its thickness is
// h / (1 + 4 h) of its width.
TEST(Sheets, FlatBoxesAreSheets) {
  const auto height = [](double thickness) { return thickness / (1.0 - 4.0 * thickness); };
  for (const bool is_turned : {false, true}) {
    const double thinnest = is_turned ? 0.12 : 0.03;
    for (const double share : {0.98, 1.02}) {
      const Mesh box = open_box({0, 0, 0}, {1, 1, height(share * thinnest)});
      const Closing closing(is_turned ? turned(box) : box);
      ASSERT_EQ(closing.loops.size(), 1U);
      EXPECT_EQ(closing.kept(), share < 1.0 ? 0U : 1U) << share;
      EXPECT_EQ(closing.solids.loops.size(), share < 1.0 ? 0U : 1U);
      EXPECT_EQ(closing.solids.is_turned, is_turned);
      EXPECT_EQ(closing.solids.has_others, share < 1.0);
    }
  }
}

TEST(Sheets, OnlySmallHolesAreClosed) {
  // 44^2 is 24 % of the rest of 100^2, 45^2 is 25.4 %.
  const Closing small(sheet_with_hole(44));
  ASSERT_EQ(small.loops.size(), 2U);
  EXPECT_EQ(small.kept(), 1U);
  EXPECT_EQ(small.loops.loop(small.is_kept[0] != 0 ? 0 : 1).size(), 4U * 44U);
  EXPECT_EQ(Closing(sheet_with_hole(45)).kept(), 0U);
}

TEST(Sheets, PartsAreCounted) {
  Mesh two = open_box({0, 0, 0}, {1, 1, 1});
  EXPECT_FALSE(Closing(two).solids.has_others);
  Mesh with_closed = two;
  with_closed.add(box_mesh({2, 0, 0}, {3, 1, 1}));
  EXPECT_TRUE(Closing(with_closed).solids.has_others);
  two.add(open_box({2, 0, 0}, {3, 1, 1}));
  const Closing closing(two);
  EXPECT_TRUE(closing.solids.has_others);
  EXPECT_EQ(closing.solids.loops, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(closing.kept(), 2U);
}

TEST(Sheets, SingleTrianglesStayOpen) {
  const std::vector<Vector3> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<std::array<std::int64_t, 3>> triangles = {{0, 1, 2}};
  const BorderLoops loops = border_loops({positions, triangles}, prefilter::Run(1));
  ASSERT_EQ(loops.size(), 1U);
  std::vector<unsigned char> is_kept(1, 1);
  drop_single_face_loops(loops, is_kept);
  EXPECT_EQ(is_kept[0], 0);
  Mesh box = open_box({0, 0, 0}, {1, 1, 1});
  const BorderLoops of_box = border_loops({box.positions, box.triangles}, prefilter::Run(1));
  is_kept[0] = 1;
  drop_single_face_loops(of_box, is_kept);
  EXPECT_EQ(is_kept[0], 1);
}

// Both halves of a sphere, this far apart.
Mesh halves(double apart) {
  Mesh halves;
  for (const bool upper : {false, true}) {
    Mesh half = sphere_mesh({0, 0, 0}, 1.0, 12);
    std::erase_if(half.triangles, [&](const auto& t) {
      double z = 0.0;
      for (const auto v : t) z += half.positions[static_cast<std::size_t>(v)][2];
      return (z > 0.0) != upper;
    });
    for (Vector3& p : half.positions) p[2] += upper ? apart : 0.0;
    halves.add(half);
  }
  return halves;
}

TEST(CapLosses, CapsThatCancelStayOpen) {
  // The inside of the whole sphere is behind the cap of each half.
  Closing whole(halves(1e-3));
  ASSERT_EQ(whole.kept(), 2U);
  whole.drop_canceling_caps();
  EXPECT_EQ(whole.kept(), 0U);
  Closing apart(halves(3.0));
  ASSERT_EQ(apart.kept(), 2U);
  apart.drop_canceling_caps();
  EXPECT_EQ(apart.kept(), 2U);
}

TEST(CapLosses, InvertedCapsStayOpen) {
  // A large solid, so that the mesh counts as right side out, and an inverted small part.
  Mesh mesh = open_box({0, 0, 0}, {1, 1, 1});
  mesh.add(turned(open_box({5, 0, 0}, {5.5, 0.5, 0.5})));
  Closing closing(mesh);
  ASSERT_EQ(closing.kept(), 2U);
  EXPECT_FALSE(closing.solids.is_turned);
  closing.drop_canceling_caps();
  EXPECT_EQ(closing.is_kept, (std::vector<unsigned char>{1, 0}));
  // If all parts are inside out, no volume is lost.
  Mesh both = turned(open_box({0, 0, 0}, {1, 1, 1}));
  both.add(turned(open_box({5, 0, 0}, {5.5, 0.5, 0.5})));
  Closing turned_closing(both);
  turned_closing.drop_canceling_caps();
  EXPECT_EQ(turned_closing.kept(), 2U);
}

}  // namespace
}  // namespace prefilter
