// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/triangle_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "prefilter/voxels/remesh/patch_editor.h"

namespace prefilter {
namespace {

using Triangle = std::array<std::int32_t, 3>;

// Random triangles whose vertices have similar numbers.
std::vector<Triangle> soup(std::int32_t vertices, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Triangle> triangles;
  while (triangles.size() < count) {
    const auto first = static_cast<std::int32_t>(random() % (static_cast<unsigned>(vertices) - 9));
    Triangle t;
    for (std::int32_t& v : t) v = first + static_cast<std::int32_t>(random() % 9);
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
  }
  return triangles;
}

TEST(TriangleParts, AlongVerticesContainEachTriangleOnceInOrder) {
  constexpr std::int32_t kVertices = 50000;  // four parts of 2^14
  const std::vector<Triangle> triangles = soup(kVertices, 90000, 1);
  const TriangleParts parts = parts_along_vertices(triangles, kVertices, prefilter::Run(1));
  ASSERT_EQ(parts.count(), 4U);
  std::vector<std::uint32_t> expected;
  for (std::int32_t part = 0; part < 4; ++part) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      if (*std::min_element(triangles[t].begin(), triangles[t].end()) / 16384 == part) {
        expected.push_back(t);
      }
    }
    EXPECT_EQ(parts.begins[static_cast<std::size_t>(part) + 1], expected.size());
  }
  EXPECT_EQ(parts.triangles, expected);
  EXPECT_EQ(parts_along_vertices(triangles, kVertices, prefilter::Run(3)).triangles, expected);
  const std::vector<std::uint32_t> numbers = parts.part_numbers(triangles.size() + 1, 77);
  EXPECT_EQ(numbers.back(), 77U);
  EXPECT_EQ(numbers[parts.part(2)[5]], 2U);

  std::vector<std::uint32_t> owners(kVertices, EditedMesh::kUnowned);
  find_owners(parts, triangles, prefilter::Run(2), &owners);
  std::vector<std::set<std::uint32_t>> all(kVertices);
  for (std::uint32_t part = 0; part < 4; ++part) {
    for (const std::uint32_t t : parts.part(part)) {
      for (const std::int32_t v : triangles[t]) all[static_cast<std::size_t>(v)].insert(part);
    }
  }
  for (std::size_t v = 0; v < all.size(); ++v) {
    EXPECT_EQ(owners[v], all[v].empty()       ? EditedMesh::kUnowned
                         : all[v].size() == 1 ? *all[v].begin()
                                              : EditedMesh::kShared);
  }
}

TEST(TriangleParts, ByInnerVerticesAreConnectedByThem) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<Triangle> triangles = soup(200, 150, seed);
    std::mt19937 random(seed);
    std::vector<std::uint8_t> is_inner(200);
    for (std::uint8_t& flag : is_inner) flag = random() % 3 == 0 ? 1 : 0;
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const auto& [a, b, c] = triangles[t];
      const auto has = [&](std::int32_t v) { return is_inner[static_cast<std::size_t>(v)] != 0; };
      if (t % 5 != 0 && (has(a) || has(b) || has(c))) chosen.push_back(t);
    }
    std::vector<std::uint32_t> parents(200);
    const TriangleParts parts = parts_by_inner_vertices(triangles, chosen, is_inner, &parents);
    // Connected components: spread the lowest number until nothing changes.
    std::map<std::uint32_t, std::uint32_t> numbers;
    for (const std::uint32_t t : chosen) numbers[t] = t;
    for (bool is_changed = true; is_changed;) {
      is_changed = false;
      for (const std::uint32_t t : chosen) {
        for (const std::uint32_t u : chosen) {
          const bool is_joined =
              std::any_of(triangles[t].begin(), triangles[t].end(), [&](std::int32_t v) {
                return is_inner[static_cast<std::size_t>(v)] != 0 &&
                       std::count(triangles[u].begin(), triangles[u].end(), v) > 0;
              });
          if (!is_joined || numbers[t] <= numbers[u]) continue;
          numbers[t] = numbers[u];
          is_changed = true;
        }
      }
    }
    std::map<std::uint32_t, std::set<std::uint32_t>> expected;
    for (const auto& [t, number] : numbers) expected[number].insert(t);
    std::set<std::set<std::uint32_t>> sets;
    for (const auto& [number, some] : expected) sets.insert(some);
    std::set<std::set<std::uint32_t>> found;
    for (std::size_t i = 0; i < parts.count(); ++i) {
      const auto part = parts.part(i);
      EXPECT_TRUE(std::is_sorted(part.begin(), part.end()));
      found.insert(std::set<std::uint32_t>(part.begin(), part.end()));
    }
    EXPECT_EQ(found, sets);
    EXPECT_EQ(parts.triangles.size(), chosen.size());
  }
  std::vector<std::uint32_t> parents;
  EXPECT_EQ(parts_by_inner_vertices({}, {}, {}, &parents).count(), 0U);
}

}  // namespace
}  // namespace prefilter
