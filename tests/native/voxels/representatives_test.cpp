// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/representatives.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "prefilter/geometry/spatial/triangle_pieces.h"

namespace prefilter {
namespace {

struct Sheet {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<Vector3> normals;
  std::vector<std::uint32_t> all;

  MeshView<std::int32_t> view() const { return {positions, triangles}; }
};

// Two sheets 4 cells wide that face away from each other, each with this many rows and columns.
Sheet sheets(int rows, int columns) {
  Sheet sheet;
  for (const double z : {0.0, 0.1}) {
    const auto first = static_cast<std::int32_t>(sheet.positions.size());
    for (int y = 0; y <= rows; ++y) {
      for (int x = 0; x <= columns; ++x)
        sheet.positions.push_back({4.0 * x / columns, 4.0 * y / rows, z});
    }
    for (std::int32_t y = 0; y < rows; ++y) {
      for (std::int32_t x = 0; x < columns; ++x) {
        const std::int32_t a = first + y * (columns + 1) + x;
        const std::int32_t b = a + columns + 1;
        sheet.triangles.push_back({a, a + 1, b + 1});
        sheet.triangles.push_back({a, b + 1, b});
      }
    }
    const auto count = static_cast<std::size_t>(2 * rows * columns);
    sheet.normals.insert(sheet.normals.end(), count, {0.0, 0.0, z > 0.0 ? 1.0 : -1.0});
  }
  sheet.all.resize(sheet.triangles.size());
  std::iota(sheet.all.begin(), sheet.all.end(), 0U);
  return sheet;
}

Sheet sheets(int rows) { return sheets(rows, rows); }

Representatives representatives(const Sheet& sheet) {
  return find_representatives(sheet.view(), sheet.normals, sheet.all,
                              [](const auto&) { return true; });
}

TEST(Representatives, SmallTrianglesHaveOnePerPosition) {
  for (const int rows : {40, 200}) {
    const Sheet sheet = sheets(rows);
    const Representatives found = representatives(sheet);
    // Positions are a quarter of a cell apart, and each sheet has one direction.
    EXPECT_LE(found.triangles.size(), 2U * 16U * 16U);
    EXPECT_EQ(found.triangles.size() + found.others.size(), sheet.all.size());
    double area = 0.0;
    for (std::size_t i = 0; i < found.triangles.size(); ++i) {
      area += found.shares[i] * triangle_area(sheet.view().corners(found.triangles[i]));
    }
    EXPECT_NEAR(area, 32.0, 1e-9);
    const std::set<std::uint32_t> chosen(found.triangles.begin(), found.triangles.end());
    for (const Represented& other : found.others) {
      EXPECT_TRUE(chosen.contains(other.representative));
      EXPECT_EQ(sheet.normals[other.triangle], sheet.normals[other.representative]);
      const Vector3 apart = triangle_middle(sheet.view().corners(other.triangle)) -
                            triangle_middle(sheet.view().corners(other.representative));
      for (const double x : apart) EXPECT_LE(std::abs(x), 0.25);
    }
  }
}

TEST(Representatives, PiecesOfNarrowTrianglesHaveOnePerPosition) {
  for (const int rows : {40, 400}) {
    const Sheet sheet = sheets(rows, 1);
    const Representatives found = representatives(sheet);
    EXPECT_EQ(found.pieces.size(), found.triangles.size());
    EXPECT_LE(found.triangles.size(), 2U * 16U * 16U);
    double area = 0.0;
    std::map<std::uint32_t, double> areas;
    for (std::size_t i = 0; i < found.triangles.size(); ++i) {
      const auto corners = found.corners(sheet.view(), i);
      EXPECT_LE(length(corners[1] - corners[0]), 1.0);
      area += found.shares[i] * triangle_area(corners);
      areas[found.triangles[i]] += triangle_area(corners);
    }
    EXPECT_NEAR(area, 32.0, 1e-9);
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const Represented& other : found.others) {
      EXPECT_TRUE(areas.contains(other.representative));
      EXPECT_EQ(sheet.normals[other.triangle], sheet.normals[other.representative]);
      EXPECT_TRUE(pairs.emplace(other.triangle, other.representative).second);
      areas[other.triangle] += other.area;
    }
    // Each triangle keeps its own area, minus the share of pieces that another triangle represents.
    for (const std::uint32_t t : sheet.all) {
      EXPECT_LE(areas[t], triangle_area(sheet.view().corners(t)) + 1e-9);
      EXPECT_GE(areas[t], 0.5 * triangle_area(sheet.view().corners(t)));
    }
  }
}

TEST(Representatives, CrossingNarrowPiecesRepresentThemselves) {
  Sheet sheet = sheets(40, 1);
  const Representatives alone = representatives(sheet);
  const auto count = static_cast<std::int32_t>(sheet.positions.size());
  for (std::int32_t i = 0; i < count; ++i) {
    const Vector3 p = sheet.positions[static_cast<std::size_t>(i)];
    sheet.positions.push_back({p[1], p[0], p[2]});
  }
  for (std::size_t t = 0; t < sheet.all.size(); ++t) {
    const auto [a, b, c] = sheet.triangles[t];
    sheet.triangles.push_back({a + count, c + count, b + count});
    sheet.normals.push_back(sheet.normals[t]);
  }
  sheet.all.resize(sheet.triangles.size());
  std::iota(sheet.all.begin(), sheet.all.end(), 0U);
  EXPECT_EQ(representatives(sheet).pieces.size(), 2 * alone.pieces.size());
}

TEST(Representatives, LargeTrianglesRepresentThemselves) {
  const Sheet sheet = sheets(8);
  const Representatives found = representatives(sheet);
  EXPECT_EQ(found.triangles, sheet.all);
  EXPECT_EQ(found.shares, std::vector<double>(sheet.all.size(), 1.0));
  EXPECT_TRUE(found.others.empty());
}

TEST(Representatives, BothFacesOfASheetHaveOneEach) {
  Sheet sheet = sheets(8);
  const std::size_t count = sheet.triangles.size();
  for (std::size_t t = 0; t < count / 2; ++t) {
    const auto [a, b, c] = sheet.triangles[t];
    sheet.triangles.push_back({c, b, a});
    sheet.normals.push_back(-1.0 * sheet.normals[t]);
  }
  sheet.all.resize(sheet.triangles.size());
  std::iota(sheet.all.begin(), sheet.all.end(), 0U);
  const Representatives found = representatives(sheet);
  ASSERT_EQ(found.triangles.size(), count);
  ASSERT_EQ(found.others.size(), count / 2);
  for (std::size_t t = 0; t < count; ++t) {
    EXPECT_EQ(found.triangles[t], t);
    EXPECT_EQ(found.are_sheets[t], t < count / 2);
    EXPECT_EQ(found.shares[t], t < count / 2 ? 2.0 : 1.0);
  }
  for (std::size_t i = 0; i < count / 2; ++i) {
    EXPECT_EQ(found.others[i].triangle, count + i);
    EXPECT_EQ(found.others[i].representative, i);
    EXPECT_TRUE(found.others[i].is_back);
  }
}

TEST(Representatives, DuplicateFacesAreNotSheets) {
  Sheet sheet = sheets(8);
  for (std::size_t t = 0; t < sheet.all.size(); ++t) {
    const auto [a, b, c] = sheet.triangles[t];
    sheet.triangles.push_back({b, c, a});
    sheet.normals.push_back(sheet.normals[t]);
  }
  sheet.all.resize(sheet.triangles.size());
  std::iota(sheet.all.begin(), sheet.all.end(), 0U);
  const Representatives found = representatives(sheet);
  EXPECT_EQ(found.triangles, sheet.all);
  EXPECT_EQ(found.are_sheets, std::vector<bool>(sheet.all.size(), false));
}

}  // namespace
}  // namespace prefilter
