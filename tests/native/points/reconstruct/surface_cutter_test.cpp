// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/surface_cutter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "prefilter/points/array_sink.h"

namespace prefilter {
namespace {

constexpr int kSide = 40;
constexpr std::size_t kWidth = 3;  // x, and the support

// Distance of a point of the square from the samples.
using Field = double (*)(const Vector3&);

double around_a_hole(const Vector3& p) {
  return std::max(0.0, 12.0 - std::hypot(p[0] - 20.0, p[1] - 20.0));
}

double nowhere(const Vector3&) { return 0.5; }

struct Cut {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<float> attributes;
  TrimReport report;
  bool is_spilled = false;
};

std::int64_t number(int x, int y) { return y * (kSide + 1) + x; }

// A square of unit cells, added in parts of some rows each.
Cut cut_square(Field field, int rows, const TrimOptions& options,
               std::uint64_t memory = std::numeric_limits<std::uint64_t>::max(),
               const std::vector<FarMidpoint<std::int64_t>>& far = {}) {
  SurfaceCutter cutter(options, kWidth, 1.0, true, memory, "");
  for (int low = 0; low < kSide; low += rows) {
    const int high = std::min(low + rows, kSide);
    std::vector<Vector3> positions;
    std::vector<float> attributes;
    for (int y = low == 0 ? 0 : low + 1; y <= high; ++y) {
      for (int x = 0; x <= kSide; ++x) {
        const Vector3 p = {1.0 * x, 1.0 * y, 0.0};
        positions.push_back(p);
        attributes.insert(attributes.end(),
                          {static_cast<float>(x), static_cast<float>(field(p)), 1.0F});
      }
    }
    std::vector<std::array<std::int64_t, 3>> triangles;
    std::vector<std::int64_t> shared;
    for (int x = 0; x <= kSide; ++x) shared.push_back(number(x, high));
    for (int y = low; y < high; ++y) {
      for (int x = 0; x < kSide; ++x) {
        triangles.push_back({number(x, y), number(x + 1, y), number(x + 1, y + 1)});
        triangles.push_back({number(x, y), number(x + 1, y + 1), number(x, y + 1)});
      }
    }
    cutter.add_vertices(std::move(positions), std::move(attributes));
    cutter.add_triangles(std::move(triangles));
    cutter.add_far_midpoints(far);
    cutter.end_part(shared);
  }
  ArraySink sink;
  Cut cut;
  cut.report = cutter.finish(prefilter::Run(), &sink);
  cut.is_spilled = cutter.is_spilled();
  cut.positions = sink.take_positions();
  cut.triangles = sink.take_triangles();
  cut.attributes = sink.take_attributes();
  EXPECT_EQ(cutter.counts().vertices, cut.positions.size());
  EXPECT_EQ(cutter.counts().triangles, cut.triangles.size());
  return cut;
}

const Vector3& corner(const Cut& cut, std::int32_t v) {
  return cut.positions[static_cast<std::size_t>(v)];
}

double area(const Cut& cut) {
  double sum = 0.0;
  for (const auto& [a, b, c] : cut.triangles) {
    const Vector3 normal = cross(corner(cut, b) - corner(cut, a), corner(cut, c) - corner(cut, a));
    EXPECT_GT(normal[2], 0.0);
    sum += 0.5 * normal[2];
  }
  return sum;
}

// Triangles by their positions, which are unique, so that the numbering of vertices does not
// matter.
std::set<std::array<Vector3, 3>> triangles_of(const Cut& cut) {
  std::set<std::array<Vector3, 3>> found;
  for (const auto& [a, b, c] : cut.triangles) {
    std::array<Vector3, 3> corners = {corner(cut, a), corner(cut, b), corner(cut, c)};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    found.insert(corners);
  }
  return found;
}

std::map<std::pair<std::int32_t, std::int32_t>, int> edges_of(const Cut& cut) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const auto& triangle : cut.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[std::minmax(triangle[i], triangle[(i + 1) % 3])];
  }
  return edges;
}

TEST(SurfaceCutter, CutsAlongTheIsoline) {
  const Cut cut = cut_square(around_a_hole, kSide, TrimOptions());
  constexpr double kRadius = 12.0 - 1.5;
  const double hole = 3.14159265358979 * kRadius * kRadius;
  EXPECT_NEAR(area(cut), kSide * kSide - hole, 0.01 * hole);
  EXPECT_NEAR(cut.report.cut, hole / (kSide * kSide), 0.003);
  EXPECT_EQ(cut.report.islands, 0U);
  int ends = 0;
  for (const auto& [edge, count] : edges_of(cut)) {
    ASSERT_LE(count, 2);
    const Vector3& p = corner(cut, edge.first);
    const double radius = std::hypot(p[0] - 20.0, p[1] - 20.0);
    if (count == 2 || radius > 15.0) continue;
    ++ends;
    EXPECT_NEAR(radius, kRadius, 0.05);
  }
  EXPECT_GT(ends, 60);
  for (std::size_t v = 0; v < cut.positions.size(); ++v) {
    EXPECT_NEAR(cut.positions[v][0], static_cast<double>(cut.attributes[kWidth * v]), 1e-5);
    EXPECT_LE(cut.attributes[kWidth * v + 1], 1.5001F);
  }
}

TEST(SurfaceCutter, PartsGiveTheSameSurface) {
  // An edge shared by two parts, with vertices nearby, and a triangle.
  const std::vector<FarMidpoint<std::int64_t>> far = {{number(3, 5), number(4, 5), 9.0F, 1.0F}};
  for (const auto& places : {std::vector<FarMidpoint<std::int64_t>>(), far}) {
    const TrimOptions options = {1.5, places.empty() ? 4.0 : 0.2, 0.0};
    const Cut whole = cut_square(around_a_hole, kSide, options,
                                 std::numeric_limits<std::uint64_t>::max(), places);
    EXPECT_FALSE(whole.is_spilled);
    for (const int rows : {1, 5, 7}) {
      for (const std::uint64_t memory : {std::uint64_t{0}, std::uint64_t{20'000}}) {
        const Cut parts = cut_square(around_a_hole, rows, options, memory, places);
        EXPECT_TRUE(parts.is_spilled);
        EXPECT_EQ(triangles_of(parts), triangles_of(whole)) << rows;
        EXPECT_EQ(parts.positions.size(), whole.positions.size());
        EXPECT_NEAR(parts.report.cut, whole.report.cut, 1e-12);
      }
    }
    for (const auto& [edge, count] : edges_of(whole)) ASSERT_LE(count, 2);
    if (!places.empty()) {
      EXPECT_LT(area(whole), area(cut_square(around_a_hole, 5, options)) - 0.1);
    }
  }
}

TEST(SurfaceCutter, KeepsAllIfNothingIsCut) {
  const std::vector<FarMidpoint<std::int64_t>> far = {{number(3, 5), number(4, 5), 3.0F, 1.0F}};
  const TrimOptions deep = {1.5, 13.0, 64.0};
  for (const Cut& cut :
       {cut_square(nowhere, 7, TrimOptions(), 0, far), cut_square(around_a_hole, 7, deep)}) {
    ASSERT_EQ(cut.positions.size(), static_cast<std::size_t>((kSide + 1) * (kSide + 1)));
    ASSERT_EQ(cut.triangles.size(), static_cast<std::size_t>(2 * kSide * kSide));
    EXPECT_EQ(cut.report.cut, 0.0);
    EXPECT_EQ(area(cut), kSide * kSide);
  }
}

TEST(SurfaceCutter, DropsSmallPartsOnlyIfSomethingIsCut) {
  // A ring is cut; the disk inside has a diameter of 3.
  const Field ring = [](const Vector3& p) {
    return std::max(0.0, 6.0 - std::abs(std::hypot(p[0] - 20.0, p[1] - 20.0) - 6.0));
  };
  const double inside = 3.14159265358979 * 1.5 * 1.5;
  const Cut kept = cut_square(ring, 7, {1.5, 4.0, inside - 1.0});
  EXPECT_EQ(kept.report.islands, 0U);
  const Cut gone = cut_square(ring, 7, {1.5, 4.0, inside + 1.0});
  EXPECT_EQ(gone.report.islands, 1U);
  EXPECT_NEAR(gone.report.island, inside / (kSide * kSide), 1e-3);
  EXPECT_NEAR(area(kept) - area(gone), inside, 0.6);
  EXPECT_NEAR(gone.report.cut, kept.report.cut, 1e-12);
}

}  // namespace
}  // namespace prefilter
