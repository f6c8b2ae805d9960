// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/nesting.h"

#include <gtest/gtest.h>

#include <array>

#include "wavelet/meshes.h"

namespace prefilter {
namespace {

using testing::box_mesh;
using testing::Mesh;

struct Box3 {
  double low;  // along all axes
  double high;
  bool is_turned = false;
  bool is_mixed = false;
};

// Which of these cubes are turned, as parts of one mesh; has_none adds a box that belongs to no
// part.
std::vector<bool> turned(const std::vector<Box3>& boxes, bool has_none = false) {
  Mesh mesh;
  std::vector<ClosedPart> parts;
  std::vector<std::uint32_t> part_of;
  for (const auto& [low, high, is_turned, is_mixed] : boxes) {
    Mesh box = box_mesh({low, low, low}, {high, high, high});
    if (is_turned) {
      for (auto& t : box.triangles) std::swap(t[1], t[2]);
    }
    ClosedPart part;
    const double side = high - low;
    part.volume = is_turned ? -side * side * side : side * side * side;
    part.area = 6.0 * side * side;
    part.triangles = 12;
    part.first_triangle = mesh.triangles.size();
    part.is_mixed = is_mixed;
    for (const Vector3& p : box.positions) part.box.include(p);
    part_of.insert(part_of.end(), 12, static_cast<std::uint32_t>(parts.size()));
    parts.push_back(part);
    mesh.add(box);
  }
  if (has_none) {
    mesh.add(box_mesh({-9, -9, -9}, {9, 9, 9}));
    part_of.insert(part_of.end(), 12, static_cast<std::uint32_t>(parts.size()));
  }
  return parts_to_turn({mesh.positions, mesh.triangles}, parts, part_of, prefilter::Run(1));
}

using Turned = std::vector<bool>;

TEST(Nesting, CavitiesStayAndOthersAreTurned) {
  EXPECT_EQ(turned({{0, 1}}), Turned({false}));
  EXPECT_EQ(turned({{0, 1, true}}), Turned({true}));
  EXPECT_EQ(turned({{0, 4}, {1, 2, true}}), Turned({false, false}));
  EXPECT_EQ(turned({{0, 4}, {5, 6, true}}), Turned({false, true}));
  EXPECT_EQ(turned({{0, 4}, {1, 2}}), Turned({false, false}));  // solid within solid
  // All are inside out: once all are turned, the cavity is right as well.
  EXPECT_EQ(turned({{0, 4, true}, {1, 2}}), Turned({true, true}));
  // A solid in a cavity in a solid, and a second cavity in the cavity.
  EXPECT_EQ(turned({{0, 9}, {1, 8, true}, {2, 7}}), Turned({false, false, false}));
  EXPECT_EQ(turned({{0, 9}, {1, 8, true}, {2, 7, true}}), Turned({false, false, true}));
}

TEST(Nesting, IgnoresTrianglesOfNoPart) {
  EXPECT_EQ(turned({{0, 4}, {5, 6, true}}, true), Turned({false, true}));
  EXPECT_EQ(turned({{0, 4, false, true}, {5, 6, false, true}}, true), Turned({false, false}));
}

TEST(Nesting, MixedPartsDependOnTheNestingDepth) {
  const auto mixed = [](double low, double high, bool is_turned = false) {
    return Box3{low, high, is_turned, true};
  };
  EXPECT_EQ(turned({mixed(0, 9)}), Turned({false}));
  EXPECT_EQ(turned({mixed(0, 9, true)}), Turned({true}));
  for (const bool way : {false, true}) {
    const Turned found = turned({mixed(0, 9), mixed(1, 8, way), mixed(2, 7), mixed(3, 6, way)});
    EXPECT_EQ(found, Turned({false, !way, false, !way}));
  }
}

}  // namespace
}  // namespace prefilter
