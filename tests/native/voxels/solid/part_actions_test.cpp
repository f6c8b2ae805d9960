// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/part_actions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "prefilter/voxels/solid/hollow_regions.h"
#include "prefilter/voxels/solid/turn_parts.h"
#include "prefilter/voxels/voxelize.h"
#include "wavelet/meshes.h"

namespace prefilter {
namespace {

using testing::box_mesh;

// Patches of one triangle each, of area 1.
Patches patches_of(const std::vector<FacePatch>& patches) {
  Patches result{patches, {}, {}};
  for (std::uint32_t p = 0; p < patches.size(); ++p) result.patch_of.push_back(p);
  return result;
}
FacePatch open_patch(std::size_t triangles = 2) {
  FacePatch patch;
  patch.triangles = triangles;
  patch.area = 1.0;
  patch.border = 1.0;
  return patch;
}
FacePatch closed_patch(double volume) {
  FacePatch patch = open_patch();
  patch.border = 0.0;
  patch.volume = volume;
  return patch;
}

TEST(PartActions, CoveredAreasAreWeightedByShares) {
  Patches patches = patches_of({open_patch(), open_patch()});
  patches.patch_of = {1, 0, 1};
  const std::vector<double> areas = {1.0, 2.0, 4.0};
  const std::vector<float> coverage = {0.25F, 1.0F, 0.5F};
  const std::vector<TriangleSides> sides = {
      {0.5F, 0.25F, 0.125F, 0.0F}, {0, 0, 0, 1}, {0, 0, 0, 0.5F}};
  const auto sums = part_areas(patches, areas, coverage, sides);
  EXPECT_EQ(sums[0].lost, 0.0);
  EXPECT_EQ(sums[0].inside, 2.0);
  EXPECT_EQ(sums[0].seen, 0.0);
  EXPECT_EQ(sums[1].lost, 0.75 + 2.0);
  EXPECT_EQ(sums[1].inside, 2.0);
  EXPECT_EQ(sums[1].seen, 0.875);
  EXPECT_EQ(part_areas(patches, areas, coverage, {})[1].inside, 0.0);
}

// The decision about one part, and whether it is thickened.
struct Judged {
  PartAction action;
  bool is_thickened;
  bool has_changed;
};
Judged judged(const FacePatch& patch, const PartAreas& areas, double thickness = 0.1) {
  std::vector<PartDecision> decisions(1);
  const bool has_changed =
      decide_parts(patches_of({patch}), std::vector{areas}, thickness, decisions);
  return {decisions[0].action, decisions[0].is_thickened, has_changed};
}

TEST(PartActions, OpenPartsDependOnTheLostArea) {
  const FacePatch open = open_patch();
  const auto action = [&](double lost, double inside, double seen) {
    return judged(open, {lost, inside, seen});
  };
  EXPECT_EQ(action(0.0, 0.0, 1.0).action, PartAction::kKeepWinding);
  EXPECT_FALSE(action(0.004, 0.0, 1.0).is_thickened);
  EXPECT_TRUE(action(0.006, 0.0, 1.0).is_thickened);
  EXPECT_FALSE(action(0.24, 0.0, 1.0).has_changed);
  EXPECT_EQ(action(0.26, 0.0, 1.0).action, PartAction::kReplaceByShell);
  EXPECT_TRUE(action(0.26, 0.0, 1.0).has_changed);
  EXPECT_EQ(action(0.51, 0.79, 0.21).action, PartAction::kReplaceByShell);
  EXPECT_EQ(action(0.51, 0.81, 0.19).action, PartAction::kDrop);
  EXPECT_EQ(action(0.49, 0.81, 0.19).action, PartAction::kReplaceByShell);
  EXPECT_EQ(judged(open, {0.6, 0.0, 1.0}, 0.0).action, PartAction::kKeepWinding);
  EXPECT_FALSE(judged(open, {0.6, 0.0, 1.0}, 0.0).is_thickened);
  EXPECT_EQ(judged(open, {0.6, 1.0, 0.0}, 0.0).action, PartAction::kDrop);
}

TEST(PartActions, ThinClosedPartsAreThickened) {
  EXPECT_TRUE(is_thin(closed_patch(-0.049), 0.1));
  EXPECT_FALSE(is_thin(closed_patch(-0.051), 0.1));
  EXPECT_FALSE(is_thin(open_patch(), 0.1));
  EXPECT_TRUE(judged(closed_patch(0.049), {0.51, 0.0, 0.0}).is_thickened);
  EXPECT_FALSE(judged(closed_patch(0.049), {0.49, 0.0, 0.0}).is_thickened);
  EXPECT_FALSE(judged(closed_patch(0.051), {0.51, 0.0, 0.0}).is_thickened);
  EXPECT_EQ(judged(closed_patch(0.049), {0.51, 1.0, 0.0}).action, PartAction::kKeepWinding);
}

TEST(PartActions, DecisionsAreFinal) {
  std::vector<PartDecision> decisions = {{PartAction::kReplaceByRegion, true}};
  EXPECT_FALSE(decide_parts(patches_of({open_patch()}), std::vector<PartAreas>{{1.0, 1.0, 0.0}},
                            0.1, decisions));
  EXPECT_EQ(decisions[0].action, PartAction::kReplaceByRegion);
  EXPECT_FALSE(decisions[0].is_thickened);
}

// A triangle of area 1 in the plane z = height, whose normal is up.
WorkMesh triangle_at(double height) {
  WorkMesh mesh;
  mesh.positions = {{0, 0, height}, {2, 0, height}, {0, 1, height}};
  mesh.triangles = {{0, 1, 2}};
  mesh.origins = {0};
  return mesh;
}

// Whether a patch of that triangle alone is turned.
bool is_turned(FacePatch patch, TriangleSides sides, double height = 0.0, double cell = 0.1) {
  patch.border_middle = {0, 0, 0};
  WorkMesh mesh = triangle_at(height);
  std::vector<TriangleSides> all = {sides};
  const TurnedParts turned =
      turn_open_parts(patches_of({patch}), std::vector{1.0}, cell, &mesh, all);
  const bool is_swapped = mesh.triangles[0] != std::array<std::int32_t, 3>{0, 1, 2};
  EXPECT_EQ(turned.any(), is_swapped);
  EXPECT_EQ(turned.faces, is_swapped && !patch.is_orientable ? 1U : 0U);
  EXPECT_EQ(all[0].outside_front, is_swapped ? sides.outside_back : sides.outside_front);
  EXPECT_EQ(all[0].outside_both, sides.outside_both);
  return is_swapped;
}

TEST(TurnParts, DependsOnTheSideOfTheOutside) {
  const auto sides = [](float both, float front, float back) {
    return TriangleSides{both, front, back, 0.0F};
  };
  const FacePatch several = open_patch(2);
  EXPECT_FALSE(is_turned(several, sides(0, 1, 0)));
  EXPECT_TRUE(is_turned(several, sides(0, 0, 1)));
  // A part with consistent normals is turned if four times as much is seen from behind.
  EXPECT_FALSE(is_turned(several, sides(0, 0.11F, 0.42F)));
  EXPECT_TRUE(is_turned(several, sides(0, 0.1F, 0.42F)));
  EXPECT_TRUE(is_turned(open_patch(1), sides(0, 0.4F, 0.42F)));
  FacePatch mixed = open_patch(2);
  mixed.turned_area = 0.1;
  EXPECT_TRUE(is_turned(mixed, sides(0, 0.4F, 0.42F)));
  EXPECT_FALSE(is_turned(several, sides(0, 0, 0.09F)));
  EXPECT_FALSE(is_turned(closed_patch(1.0), sides(0, 0, 1)));
  FacePatch none = open_patch(2);  // it cannot be oriented
  none.is_orientable = false;
  EXPECT_TRUE(is_turned(none, sides(0, 0.4F, 0.42F)));
  EXPECT_FALSE(is_turned(none, sides(0, 0.42F, 0.4F)));
}

TEST(TurnParts, WideOpenPartsDependOnTheirVolume) {
  // The cone from the origin over a triangle of area 1 in the plane z = h has the volume h / 3.
  const TriangleSides open{0.6F, 0.0F, 0.4F, 0.0F};
  EXPECT_TRUE(is_turned(open_patch(), open, -0.31));
  EXPECT_FALSE(is_turned(open_patch(), open, -0.29));
  EXPECT_FALSE(is_turned(open_patch(), open, 0.31));
  EXPECT_TRUE(is_turned(open_patch(), {0.4F, 0.0F, 0.6F, 0.0F}, 0.31));
}

TEST(HollowRegions, AreBoundedByOpenPartsAndUnfilled) {
  Patches patches = patches_of({open_patch(), closed_patch(1.0), open_patch()});
  const auto beside = [](ReachGrid::Label region, float share) {
    TriangleSides sides;
    sides.region = region;
    sides.outside_front = share;
    return sides;
  };
  const std::vector<double> areas = {2.0, 1.0, 1.0};
  std::vector<TriangleSides> sides = {beside(3, 1.0F), beside(3, 1.0F), beside(4, 0.4F)};
  patches.patches[0].area = 2.0;
  const auto hollow = [&](double third, double fourth) {
    return hollow_regions(patches, areas, sides, std::vector{0.0, 0.0, 0.0, third, fourth});
  };
  EXPECT_EQ(hollow(0.89, 0.91), (std::vector{false, false, false, true, false}));
  EXPECT_EQ(hollow(0.91, 0.89), (std::vector{false, false, false, false, true}));
  EXPECT_EQ(parts_around(patches, areas, sides, hollow(0.0, 0.0)), (std::vector<std::size_t>{0}));
  sides[2].outside_back = 0.2F;
  EXPECT_EQ(parts_around(patches, areas, sides, hollow(0.0, 0.0)),
            (std::vector<std::size_t>{0, 2}));
  patches.patches[1].area = 3.0;  // more of region 3 is bounded by the closed part
  EXPECT_EQ(hollow_regions(patches, std::vector{2.0, 3.0, 1.0}, sides, std::vector<double>(5)),
            (std::vector{false, false, false, false, true}));
  sides[0].region = 4;  // now all of it is
  EXPECT_EQ(hollow(0.0, 0.0), (std::vector{false, false, false, false, true}));
}

// The grid around a closed box assigns the right regions to the sides of its triangles.
TEST(TriangleSides, SeparateTheInsideOfABoxFromTheOutside) {
  const auto box = box_mesh({0, 0, 0}, {1, 1, 1});
  const MeshView<std::int32_t> mesh{box.positions, box.triangles};
  const ReachGrid grid(mesh, 0.05, 0.0, prefilter::Run(1));
  for (const TriangleSides& sides : sides_of_triangles(mesh, grid, prefilter::Run(1))) {
    EXPECT_GT(sides.outside_front, 0.8F);  // except close to its edges
    EXPECT_EQ(sides.outside_back + sides.outside_both + sides.inside_both, 0.0F);
    EXPECT_EQ(sides.region, ReachGrid::kFirstRegion);
  }
  auto other = box;
  for (auto& t : other.triangles) std::swap(t[1], t[2]);
  const MeshView<std::int32_t> turned{other.positions, other.triangles};
  for (const TriangleSides& sides : sides_of_triangles(turned, grid, prefilter::Run(1))) {
    EXPECT_GT(sides.outside_back, 0.8F);
    EXPECT_EQ(sides.outside_front, 0.0F);
  }
  // Voxelized whole, all of the region is inside; voxelized by half, half of it.
  VoxelizeOptions options;
  options.depth = 6;
  options.bounds = Box{{-1, -1, -1}, {2, 2, 2}};
  const Octree octree = voxelize({box.positions, box.triangles}, options);
  EXPECT_EQ(filled_shares(grid, octree, 1)[ReachGrid::kFirstRegion], 1.0);
  const auto half = box_mesh({0, 0, 0}, {1, 1, 0.5});
  const Octree lower = voxelize({half.positions, half.triangles}, options);
  EXPECT_NEAR(filled_shares(grid, lower, 1)[ReachGrid::kFirstRegion], 0.5, 0.06);
}

}  // namespace
}  // namespace prefilter
