// SPDX-License-Identifier: GPL-3.0-or-later

// Tests each phase of finding the smooth regions of meshes.

#include "prefilter/voxels/contour/source_regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "prefilter/voxels/contour/region_borders.h"
#include "prefilter/voxels/contour/region_corners.h"
#include "prefilter/voxels/contour/smooth_regions.h"

namespace prefilter {
namespace {

constexpr double kNoFacets = std::numeric_limits<double>::infinity();

constexpr Box kUnit = {{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};

struct Source {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<std::int32_t> groups;

  std::vector<SourceMesh> meshes() const { return {{{positions, triangles}, groups}}; }
  WeldedMeshes welded() const { return WeldedMeshes(meshes(), RootFrame(kUnit)); }
};

// A height field over n x n squares, given at their corners, without a skirt.
template <typename Height>
Source terrain(int n, const Height& height) {
  Source made;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      made.positions.push_back({static_cast<double>(i), static_cast<double>(j), height(i, j)});
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const std::int64_t a = i * (n + 1) + j;
      made.triangles.push_back({a, a + n + 1, a + n + 2});
      made.triangles.push_back({a, a + n + 2, a + 1});
    }
  }
  return made;
}

// A cube of n x n squares per side; each side has vertices of its own.
Source cube_of_sides(int n) {
  Source made;
  for (int side = 0; side < 6; ++side) {
    const Source flat = terrain(n, [&](int, int) { return side % 2 == 0 ? 0.0 : 1.0 * n; });
    const auto first = static_cast<std::int64_t>(made.positions.size());
    for (const Vector3& p : flat.positions) {
      Vector3 turned;
      for (int a = 0; a < 3; ++a) turned[(a + side / 2) % 3] = p[a];
      made.positions.push_back(turned);
    }
    for (auto [a, b, c] : flat.triangles) {
      if (side % 2 == 0) std::swap(b, c);
      made.triangles.push_back({a + first, b + first, c + first});
    }
  }
  return made;
}

// Labels connected components of triangles in order of their first triangle, by growing sets.
template <typename AreJoined>
std::vector<std::int32_t> connected(std::size_t count, const AreJoined& are_joined) {
  std::vector<std::int32_t> numbers(count, -1);
  std::int32_t next = 0;
  for (std::size_t t = 0; t < count; ++t) {
    if (numbers[t] >= 0) continue;
    std::vector<std::size_t> waiting = {t};
    numbers[t] = next;
    while (!waiting.empty()) {
      const std::size_t at = waiting.back();
      waiting.pop_back();
      for (std::size_t u = 0; u < count; ++u) {
        if (numbers[u] >= 0 || !are_joined(at, u)) continue;
        numbers[u] = next;
        waiting.push_back(u);
      }
    }
    ++next;
  }
  return numbers;
}

TEST(SmoothRegions, FindTheFirstVertexAtEachPosition) {
  Source source = cube_of_sides(3);
  const WeldedMeshes welded = source.welded();
  const std::vector<std::int32_t> firsts = first_places(welded.positions, prefilter::Run(2));
  for (std::size_t v = 0; v < firsts.size(); ++v) {
    std::size_t expected = 0;
    while (source.positions[expected] != source.positions[v]) ++expected;
    EXPECT_EQ(static_cast<std::size_t>(firsts[v]), expected);
  }
}

TEST(SmoothRegions, EqualConnectedComponents) {
  std::mt19937 random(2);
  for (const bool has_groups : {false, true}) {
    // Hills and cliffs.
    Source source = terrain(12, [&](int i, int j) {
      return 0.1 * static_cast<double>(random() % 4) + (i > 4 ? 1.0 : 0.0) + (j > 7 ? 2.0 : 0.0);
    });
    for (std::size_t t = 0; has_groups && t < source.triangles.size(); ++t) {
      source.groups.push_back(t > 100 ? 1 : 0);
    }
    WeldedMeshes welded = source.welded();
    const SmoothRegions found = join_smooth(kNoFacets, prefilter::Run(3), &welded);
    const auto shared = [&](std::size_t t, std::size_t u) {
      std::vector<std::int64_t> both;
      for (const std::int64_t v : source.triangles[t]) {
        const auto& other = source.triangles[u];
        if (std::find(other.begin(), other.end(), v) != other.end()) both.push_back(v);
      }
      return both;
    };
    const auto is_smooth = [&](std::size_t t, std::size_t u) {
      const Vector3 a = welded.normal(t);
      const Vector3 b = welded.normal(u);
      const double angle = std::atan2(length(cross(a, b)), dot(a, b));
      return angle <= std::numbers::pi / 9.0 &&
             (!has_groups || source.groups[t] == source.groups[u]);
    };
    const auto is_of_region = [&](std::size_t t, std::size_t u) {
      return shared(t, u).size() == 2 && is_smooth(t, u);
    };
    const auto is_of_part = [&](std::size_t t, std::size_t u) { return shared(t, u).size() == 2; };
    EXPECT_EQ(found.labels, connected(source.triangles.size(), is_of_region));
    EXPECT_EQ(found.parts, connected(source.triangles.size(), is_of_part));
    EXPECT_EQ(found.region_count, *std::max_element(found.labels.begin(), found.labels.end()) + 1);
    EXPECT_GT(found.region_count, 4);
    std::size_t walls = 0;
    for (std::size_t t = 0; t < source.triangles.size(); ++t) {
      for (std::size_t u = 0; u < t; ++u) {
        if (shared(t, u).size() == 2 && !is_smooth(t, u)) ++walls;
      }
    }
    EXPECT_EQ(found.walls.size(), walls);
    for (const Wall& wall : found.walls) {
      EXPECT_LT(wall.ends[0], wall.ends[1]);
      EXPECT_EQ(shared(static_cast<std::size_t>(wall.triangles[0]),
                       static_cast<std::size_t>(wall.triangles[1]))
                    .size(),
                2U);
    }
  }
}

TEST(SmoothRegions, SeparateTheSidesOfACube) {
  // Nothing is connected until vertices at equal positions are welded.
  const Source source = cube_of_sides(4);
  WeldedMeshes welded = source.welded();
  const SmoothRegions found = join_smooth(kNoFacets, prefilter::Run(2), &welded);
  EXPECT_FALSE(welded.firsts.empty());
  EXPECT_EQ(found.region_count, 6);
  EXPECT_EQ(found.part_count, 1);
  EXPECT_EQ(found.walls.size(), 12U * 4U);
  const SourceRegions regions =
      find_regions(source.meshes(), RootFrame(kUnit), 0.5, prefilter::Run(1));
  EXPECT_EQ(regions.borders.size(), 12U * 4U);
  EXPECT_EQ(regions.corners.size(), 8U);
  for (const RegionCorner& corner : regions.corners) {
    EXPECT_EQ(corner.labels.size(), 3U);
    EXPECT_TRUE(std::is_sorted(corner.labels.begin(), corner.labels.end()));
    const Vector3 p = regions.positions[static_cast<std::size_t>(corner.vertex)];
    for (int a = 0; a < 3; ++a) EXPECT_TRUE(p[a] == 0.0 || p[a] == 4.0);
  }
}

// Rows of two triangles each between x = 0 and 9, through these points (y, z).
Source ramp(const std::vector<std::array<double, 2>>& profile) {
  Source source;
  for (const auto& [y, z] : profile) {
    source.positions.push_back({0.0, y, z});
    source.positions.push_back({9.0, y, z});
  }
  for (std::int32_t i = 0; i + 1 < static_cast<std::int32_t>(profile.size()); ++i) {
    const std::int32_t at = 2 * i;
    source.triangles.push_back({at, at + 1, at + 3});
    source.triangles.push_back({at, at + 3, at + 2});
  }
  return source;
}

TEST(SmoothRegions, AreWideFacetsWhereEdgesAreBlunt) {
  // Edges of 5.7 degrees, of 0.5 degrees in total, and of 5.7 again next to rows 0.2 wide.
  const Source source = ramp({{0, 0}, {4, 0}, {8, 0.4}, {12, 0.835}, {12.2, 0.835}, {12.4, 0.8}});
  WeldedMeshes welded = source.welded();
  EXPECT_EQ(join_smooth(kNoFacets, prefilter::Run(1), &welded).region_count, 1);
  SmoothRegions regions = join_smooth(1.5, prefilter::Run(2), &welded);
  EXPECT_EQ(regions.region_count, 3);
  EXPECT_EQ(regions.labels, (std::vector<std::int32_t>{0, 0, 1, 1, 1, 1, 2, 2, 2, 2}));
  ASSERT_EQ(regions.walls.size(), 2U);
  EXPECT_TRUE(regions.walls[0].is_crease && regions.walls[1].is_crease);
  // The rows are too narrow for an edge of their own.
  const RegionAreas areas =
      measure_regions(welded, regions.region_count, prefilter::Run(), &regions.labels);
  join_small(welded, areas.regions, 0.1, 1.0, &regions);
  EXPECT_EQ(regions.labels, (std::vector<std::int32_t>{0, 0, 1, 1, 1, 1, 1, 1, 1, 1}));
  const std::vector<RegionBorder> borders = find_borders(welded, 1.0, &regions);
  ASSERT_EQ(borders.size(), 1U);
  EXPECT_EQ(borders[0].ends, (std::array<std::int32_t, 2>{2, 3}));
}

TEST(SmoothRegions, RoundOffEdgesThatHardlyStandOut) {
  // Edges of 5.7 degrees between facets 2.2 wide, as in a strip of triangles, and of 11.3 degrees.
  const auto regions_of = [](double rise) {
    const Source source = ramp({{0, 0}, {2.2, 0}, {4.4, rise}});
    WeldedMeshes welded = source.welded();
    return join_smooth(1.5, prefilter::Run(1), &welded).region_count;
  };
  EXPECT_EQ(regions_of(0.1), 1);
  EXPECT_EQ(regions_of(0.44), 2);
}

TEST(RegionBorders, GiveSmallRegionsToTheNeighborWithTheLongestWall) {
  // A plane, a wall, a small strip on top of it and a slope that begins at the strip.
  Source source;
  source.positions = {{0, 0, 0}, {9, 0, 0},   {9, 9, 0},   {0, 9, 0}, {0, 9, 1},
                      {9, 9, 1}, {9, 9.5, 1}, {0, 9.2, 1}, {5, 20, 9}};
  source.triangles = {{0, 1, 2}, {0, 2, 3}, {3, 2, 5}, {3, 5, 4}, {4, 5, 6}, {4, 6, 7}, {7, 6, 8}};
  WeldedMeshes welded = source.welded();
  SmoothRegions regions = join_smooth(kNoFacets, prefilter::Run(1), &welded);
  ASSERT_EQ(regions.region_count, 4);
  const RegionAreas areas =
      measure_regions(welded, regions.region_count, prefilter::Run(), &regions.labels);
  EXPECT_NEAR(areas.regions[0], 81.0, 1e-12);
  EXPECT_NEAR(areas.regions[1], 9.0, 1e-12);
  EXPECT_NEAR(areas.regions[2], 9.0 * 0.5 * (0.5 + 0.2), 1e-12);
  EXPECT_NEAR(static_cast<double>(areas.vertices[0]), 81.0, 1e-5);
  join_small(welded, areas.regions, 4.0, 0.0, &regions);
  // The strip's border with the slope, from (9, 9.5) to (0, 9.2), is slightly longer than 9.
  EXPECT_EQ(regions.region_count, 3);
  EXPECT_EQ(regions.labels, (std::vector<std::int32_t>{0, 0, 1, 1, 2, 2, 2}));
}

TEST(RegionBorders, IgnoreTrianglesWithoutArea) {
  Source source = terrain(2, [](int, int) { return 0.0; });
  source.triangles.push_back({0, 1, 1});
  WeldedMeshes welded = source.welded();
  SmoothRegions regions = join_smooth(kNoFacets, prefilter::Run(1), &welded);
  measure_regions(welded, regions.region_count, prefilter::Run(), &regions.labels);
  EXPECT_EQ(regions.labels.back(), -1);
  EXPECT_EQ(regions.labels.front(), 0);
}

// A roof over the plane, folded along a line.
std::vector<std::uint8_t> smooth_along(const std::vector<Vector3>& line, double steepness,
                                       double least) {
  Source source;
  std::vector<RegionBorder> borders;
  for (const Vector3& p : line) {
    source.positions.push_back(p);
    source.positions.push_back(p + Vector3{0.0, 1.0, -steepness});
    source.positions.push_back(p + Vector3{0.0, -1.0, -steepness});
  }
  for (std::int32_t i = 0; i + 1 < static_cast<std::int32_t>(line.size()); ++i) {
    source.triangles.push_back({3 * i, 3 * i + 3, 3 * i + 1});
    source.triangles.push_back({3 * i + 3, 3 * i, 3 * i + 2});
    borders.push_back({{3 * i, 3 * i + 3}, {0, 1}, {2 * i, 2 * i + 1}});
  }
  return are_smooth(source.welded(), borders, least, 1.0);
}

TEST(RegionBorders, AreSmoothUnlessTheyZigzagOrAreShort) {
  std::vector<Vector3> straight;
  std::vector<Vector3> zigzag;
  for (int i = 0; i <= 10; ++i) {
    straight.push_back({static_cast<double>(i), 0.0, 0.0});
    zigzag.push_back({static_cast<double>(i), 0.8 * (i % 2), 0.0});
  }
  const std::vector<std::uint8_t> all(10, 1);
  const std::vector<std::uint8_t> none(10, 0);
  EXPECT_EQ(smooth_along(straight, 0.3, 8.0), all);
  EXPECT_EQ(smooth_along(straight, 0.3, 10.5), none);
  EXPECT_EQ(smooth_along(zigzag, 0.25, 0.0), none);  // 36 degrees on average
  EXPECT_EQ(smooth_along(zigzag, 0.6, 0.0), all);    // no longer blunt
  for (Vector3& p : zigzag) p[0] *= 16.0;            // turns less, and is long
  EXPECT_EQ(smooth_along(zigzag, 0.25, 0.0), all);
}

TEST(RegionCorners, AreWhereBordersMeetEndOrTurn) {
  Source source;
  source.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0.5, 0}, {3, 2, 0}, {0, 5, 0}, {1, 5, 0}};
  source.triangles = {{0, 1, 2}};
  const std::vector<RegionBorder> borders = {{{0, 1}, {7, 3}, {}},
                                             {{2, 1}, {3, 7}, {}},   // turns by 27 degrees
                                             {{2, 3}, {3, 8}, {}},   // by 30 at 2: 56 - 27
                                             {{3, 4}, {8, 8}, {}},   // turns sharply
                                             {{4, 5}, {1, 2}, {}}};  // turns sharply
  const std::vector<RegionCorner> corners = border_corners(source.welded().positions, borders);
  std::map<std::int32_t, std::vector<std::int32_t>> found;
  for (const RegionCorner& corner : corners) found[corner.vertex] = corner.labels;
  const std::map<std::int32_t, std::vector<std::int32_t>> expected = {
      {0, {3, 7}}, {3, {3, 8}}, {4, {1, 2, 8}}, {5, {1, 2}}};
  EXPECT_EQ(found, expected);
}

TEST(RegionCorners, IncludeTheTipsOfCones) {
  for (const auto& [height, is_tip] : {std::pair{3.0, true}, {0.8, false}}) {
    Source source;
    source.positions = {{0, 0, height}};
    constexpr int kAround = 60;
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kAround;
      source.positions.push_back({std::cos(angle), std::sin(angle), 0.0});
      source.triangles.push_back({0, 1 + i, 1 + (i + 1) % kAround});
    }
    WeldedMeshes welded = source.welded();
    SmoothRegions regions = join_smooth(kNoFacets, prefilter::Run(1), &welded);
    EXPECT_EQ(regions.region_count, 1);
    const RegionAreas areas = measure_regions(welded, 1, prefilter::Run(), &regions.labels);
    std::vector<std::uint8_t> is_on_wall(source.positions.size(), 1);
    is_on_wall[0] = 0;
    const auto found = [&](double least) {
      return tips(welded, regions.labels, is_on_wall, areas.vertices, least);
    };
    // The mean normal's length is the cosine of the slope: 0.32 and 0.78.
    EXPECT_EQ(found(0.0).size(), is_tip ? 1U : 0U);
    EXPECT_TRUE(found(100.0).empty());
    if (is_tip) {
      EXPECT_EQ(found(0.0)[0].labels, (std::vector<std::int32_t>{0}));
    }
    is_on_wall[0] = 1;
    EXPECT_TRUE(found(0.0).empty());
  }
}

}  // namespace
}  // namespace prefilter
