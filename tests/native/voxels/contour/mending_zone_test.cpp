// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/mending_zone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace prefilter {
namespace {

using Flags = std::vector<std::uint8_t>;

constexpr std::int32_t kSide = 40;
constexpr double kCell = 0.5;

// A plane of square loops, one per cell, each linked to its four neighbors. Every even loop has a
// triangle far from edges, every third one a triangle near them.
struct Sheet {
  LinkedLoops loops;
  LayeredMesh layered;
  LoopStates states;
  LoopChanges changes;

  Sheet() {
    FacetedMesh& mesh = layered.mesh;
    for (std::int32_t y = 0; y <= kSide; ++y) {
      for (std::int32_t x = 0; x <= kSide; ++x) mesh.positions.push_back({kCell * x, kCell * y, 0});
    }
    const auto vertex = [](std::int32_t x, std::int32_t y) { return y * (kSide + 1) + x; };
    const auto loop_at = [](std::int32_t x, std::int32_t y) {
      return x < 0 || y < 0 || x >= kSide || y >= kSide ? -1 : y * kSide + x;
    };
    for (std::int32_t y = 0; y < kSide; ++y) {
      for (std::int32_t x = 0; x < kSide; ++x) {
        SharpLoop loop;
        loop.count = 4;
        loop.corners = {vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1)};
        loops.loops.push_back(loop);
        std::array<LoopSide, 12> sides;
        sides[0].other = loop_at(x, y - 1);
        sides[1].other = loop_at(x + 1, y);
        sides[2].other = loop_at(x, y + 1);
        sides[3].other = loop_at(x - 1, y);
        loops.sides.push_back(sides);
      }
    }
    for (std::size_t step : {2U, 3U}) {
      for (std::size_t i = 0; i < loops.size(); i += step) {
        const auto& corners = loops.loops[i].corners;
        mesh.triangles.push_back({corners[0], corners[1], corners[2]});
        mesh.labels.push_back(static_cast<std::int32_t>(i));
      }
      (step == 2 ? layered.near : layered.loops) = mesh.triangles.size();
    }
    mesh.kinds.assign(mesh.positions.size(), VertexKind::kSurface);
    layered.contour_vertices = mesh.positions.size();
    states.features.resize(loops.size());
    for (std::size_t i = 0; i < loops.size(); ++i) {
      states.features[i].position = {static_cast<double>(i), 0.0, 0.0};
      states.merged.push_back(i);
    }
    for (Flags* flags : {&states.is_sharp, &states.is_single, &states.attempts, &states.halvings}) {
      flags->assign(loops.size(), 0);
    }
    changes = {Flags(loops.size(), 0), Flags(mesh.positions.size(), 0)};
  }

  Vector3 place(std::size_t loop) const {
    return layered.mesh.positions[static_cast<std::size_t>(loops.loops[loop].corners[0])];
  }
};

double distance_along_axes(const Vector3& a, const Vector3& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

TEST(MendingZone, ContainsTheSurroundingsOfChanges) {
  Sheet sheet;
  const std::size_t loop = 3 * kSide + 5;
  const std::size_t moved = 20 * (kSide + 1) + 30;
  sheet.changes.loops[loop] = 1;
  sheet.changes.vertices[moved] = 1;
  const std::vector<Vector3> positions = sheet.layered.mesh.positions;
  const std::vector<Vector3> changed = {sheet.place(loop), positions[moved]};
  const auto nearest = [&](const Vector3& p) {
    return std::min(distance_along_axes(p, changed[0]), distance_along_axes(p, changed[1]));
  };
  std::vector<Vector3> places;
  for (std::size_t i = 0; i < sheet.loops.size(); ++i) places.push_back(sheet.place(i));
  const ZoneFinder finder(sheet.loops, sheet.layered, kCell);
  EXPECT_FALSE(ZoneFinder::are_most(sheet.changes));
  const MendingZone zone =
      finder.enter(sheet.loops, sheet.states, &sheet.changes, &sheet.layered).value();
  EXPECT_EQ(zone.layered.mesh.positions, positions);
  // In cubes of four cells: the zone reaches two cubes beyond the change, its inner part one cube.
  std::size_t at = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const bool is_here = at < zone.numbers.size() && zone.numbers[at] == i;
    const double cells = nearest(places[i]) / kCell;
    EXPECT_TRUE(is_here || cells > 8.0) << i;
    EXPECT_TRUE(!is_here || cells <= 12.0) << i;
    if (!is_here) continue;
    EXPECT_TRUE(zone.is_inside[at] != 0 || cells > 4.0) << i;
    EXPECT_TRUE(zone.is_inside[at] == 0 || cells <= 8.0) << i;
    EXPECT_EQ(zone.changes.loops[at], i == loop ? 1 : 0);
    EXPECT_EQ(zone.loops.loops[at].corners, sheet.loops.loops[i].corners);
    for (std::size_t k = 0; k < 4; ++k) {
      const std::int32_t other = sheet.loops.sides[i][k].other;
      const std::int32_t local = zone.loops.sides[at][k].other;
      const bool is_there =
          other >= 0 && std::binary_search(zone.numbers.begin(), zone.numbers.end(),
                                           static_cast<std::size_t>(other));
      ASSERT_EQ(local >= 0, is_there) << i;
      EXPECT_TRUE(!is_there ||
                  zone.numbers[static_cast<std::size_t>(local)] == static_cast<std::size_t>(other));
    }
    ++at;
  }
  EXPECT_EQ(at, zone.numbers.size());
}

TEST(MendingZone, ContainsTrianglesInOrder) {
  Sheet sheet;
  sheet.changes.loops[0] = 1;
  const LayeredMesh before = sheet.layered;
  const ZoneFinder finder(sheet.loops, sheet.layered, kCell);
  const MendingZone zone =
      finder.enter(sheet.loops, sheet.states, &sheet.changes, &sheet.layered).value();
  const auto expected = [&](std::size_t begin, std::size_t end) {
    std::vector<std::int32_t> labels;
    for (std::size_t t = begin; t < end; ++t) {
      const auto v = static_cast<std::size_t>(before.mesh.triangles[t][0]);
      const Vector3& p = before.mesh.positions[v];
      // Along each axis, the changed loop is in the first of three cubes.
      if (std::max(p[0], p[1]) < 12.0 * kCell) labels.push_back(before.mesh.labels[t]);
    }
    return labels;
  };
  const std::vector<std::int32_t>& labels = zone.layered.mesh.labels;
  const auto near = labels.begin() + static_cast<std::ptrdiff_t>(zone.layered.near);
  EXPECT_EQ(std::vector(labels.begin(), near), expected(0, before.near));
  EXPECT_EQ(std::vector(near, labels.end()), expected(before.near, before.loops));
  EXPECT_EQ(zone.layered.loops, labels.size());
}

TEST(MendingZone, ReturnsItsTrianglesAndInnerChanges) {
  Sheet sheet;
  const std::size_t loop = 20 * kSide + 20;
  sheet.changes.loops[loop] = 1;
  const std::vector<Vector3> positions = sheet.layered.mesh.positions;
  const ZoneFinder finder(sheet.loops, sheet.layered, kCell);
  MendingZone zone =
      finder.enter(sheet.loops, sheet.states, &sheet.changes, &sheet.layered).value();
  const std::vector<std::size_t> numbers = zone.numbers;
  const Flags is_inside = zone.is_inside;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    zone.states.features[k].position[1] = 7.0;
    zone.states.is_single[k] = 1;
    zone.states.merged[k] = 0;
    zone.changes.loops[k] = k == 1 ? 1 : 0;
  }
  zone.changes.vertices[3] = 1;
  ZoneFinder::leave(std::move(zone), &sheet.states, &sheet.changes, &sheet.layered);
  EXPECT_EQ(sheet.layered.mesh.positions, positions);
  EXPECT_EQ(sheet.layered.mesh.kinds.size(), positions.size());
  EXPECT_EQ(sheet.changes.vertices[3], 1);
  EXPECT_EQ(sheet.changes.loops[loop], 0);
  EXPECT_EQ(sheet.changes.loops[numbers[1]], 1);
  std::size_t at = 0;
  for (std::size_t i = 0; i < sheet.loops.size(); ++i) {
    const bool is_here = at < numbers.size() && numbers[at] == i;
    const bool is_of_inside = is_here && is_inside[at] != 0;
    EXPECT_EQ(sheet.states.features[i].position[1], is_here ? 7.0 : 0.0);
    EXPECT_EQ(sheet.states.is_single[i], is_of_inside ? 1 : 0);
    EXPECT_EQ(sheet.states.merged[i], is_of_inside ? numbers[0] : i);
    if (is_here) ++at;
  }
}

TEST(MendingZone, RequiresFewChanges) {
  Sheet sheet;
  EXPECT_FALSE(ZoneFinder::are_most(sheet.changes));
  for (std::size_t i = 0; i < sheet.changes.loops.size(); ++i) {
    sheet.changes.loops[i] = i % 3 != 0 ? 1 : 0;
  }
  EXPECT_TRUE(ZoneFinder::are_most(sheet.changes));
}

TEST(MendingZone, IsNoneIfItWouldHaveMostTriangles) {
  const Sheet unchanged;
  // Many loops all over the sheet, then loops whose surroundings make up more than half of it.
  for (const std::vector<std::size_t>& places :
       {std::vector<std::size_t>{2, 6, 10, 14, 18, 22, 26, 30, 34, 38}, {10, 30}}) {
    Sheet sheet;
    for (const std::size_t y : places) {
      for (const std::size_t x : places) sheet.changes.loops[y * kSide + x] = 1;
    }
    const Flags changed = sheet.changes.loops;
    const ZoneFinder finder(sheet.loops, sheet.layered, kCell);
    EXPECT_FALSE(finder.enter(sheet.loops, sheet.states, &sheet.changes, &sheet.layered));
    EXPECT_EQ(sheet.layered.mesh.positions, unchanged.layered.mesh.positions);
    EXPECT_EQ(sheet.changes.loops, changed);
    EXPECT_EQ(sheet.changes.vertices.size(), unchanged.changes.vertices.size());
  }
}

}  // namespace
}  // namespace prefilter
