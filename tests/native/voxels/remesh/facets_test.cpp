// SPDX-License-Identifier: GPL-3.0-or-later

// Tests meshes divided into patches and put together again.

#include "prefilter/voxels/remesh/facets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "prefilter/voxels/remesh/patch_division.h"

namespace prefilter {
namespace {

using Triangle = std::array<std::int32_t, 3>;

struct Grid {
  std::vector<Vector3> positions;
  std::vector<Triangle> triangles;
};

// A grid of squares of two triangles each, in random order.
Grid grid(int n) {
  Grid made;
  for (int i = 0; i < (n + 1) * (n + 1); ++i) {
    made.positions.push_back({static_cast<double>(i / (n + 1)), 1.0 * (i % (n + 1)), 0.0});
  }
  for (int i = 0; i < n * n; ++i) {
    const std::int32_t a = i / n * (n + 1) + i % n;
    made.triangles.push_back({a, a + n + 1, a + n + 2});
    made.triangles.push_back({a, a + n + 2, a + 1});
  }
  std::shuffle(made.triangles.begin(), made.triangles.end(), std::mt19937(3));
  return made;
}

TEST(PatchDivision, GivesEachTriangleToOnePatchAndOwnersToVertices) {
  const Grid mesh = grid(160);  // four patches
  std::vector<PatchDivision> all;
  for (const int number : {0, 1, 2}) {
    const PatchDivision made =
        divide_into_patches(mesh.positions, mesh.triangles, number, prefilter::Run(1));
    EXPECT_EQ(made.count(), 4U);
    std::vector<std::uint32_t> order = made.order;
    std::sort(order.begin(), order.end());
    for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i);
    std::vector<std::set<std::int32_t>> patches(mesh.positions.size());
    for (std::size_t patch = 0; patch < made.count(); ++patch) {
      for (const std::uint32_t t : made.triangles(patch)) {
        for (const std::int32_t v : mesh.triangles[t]) {
          patches[as_index(v)].insert(static_cast<std::int32_t>(patch));
        }
      }
    }
    std::size_t shared = 0;
    for (std::size_t v = 0; v < patches.size(); ++v) {
      shared += patches[v].size() > 1 ? 1 : 0;
      EXPECT_EQ(made.owners[v],
                patches[v].size() > 1 ? PatchDivision::kShared : *patches[v].begin());
    }
    EXPECT_LT(shared, 8U * 160U);  // borders are short: patches are compact
    EXPECT_GT(shared, 100U);
    const PatchDivision other =
        divide_into_patches(mesh.positions, mesh.triangles, number, prefilter::Run(3));
    EXPECT_EQ(other.order, made.order);
    EXPECT_EQ(other.owners, made.owners);
    all.push_back(made);
  }
  // Most vertices that one division shares are inside a patch of the next.
  std::size_t both = 0;
  std::size_t first = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (all[0].owners[v] != PatchDivision::kShared) continue;
    ++first;
    both += all[1].owners[v] == PatchDivision::kShared ? 1 : 0;
  }
  EXPECT_LT(both, first / 4);
}

TEST(PatchDivision, IsOnePatchForSmallMeshes) {
  Grid mesh = grid(4);
  mesh.positions.push_back({9, 9, 9});  // has no triangle
  const PatchDivision made =
      divide_into_patches(mesh.positions, mesh.triangles, 5, prefilter::Run(2));
  EXPECT_EQ(made.count(), 1U);
  EXPECT_EQ(made.owners.back(), PatchDivision::kUnowned);
  EXPECT_EQ(std::count(made.owners.begin(), made.owners.end(), 0), 25);
}

TEST(Facets, SurviveDivisionIntoPatches) {
  const Grid mesh = grid(120);  // two patches
  Facets before;
  before.triangles = mesh.triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    before.labels.push_back(static_cast<std::int32_t>(t));
    before.creases.push_back(static_cast<std::uint8_t>(t % 8));
    before.errors.push_back(static_cast<float>(t));
    before.deviations.push_back(static_cast<float>(t) / 2.0F);
    before.crease_errors.push_back({static_cast<float>(t), 1.0F, 2.0F});
    for (std::size_t k = t % 3; k > 0; --k) {
      before.points.push_back({static_cast<double>(t), 1.0 * static_cast<double>(k), 0.5});
    }
    before.point_ends.push_back(static_cast<std::uint32_t>(before.points.size()));
  }
  const PatchDivision division =
      divide_into_patches(mesh.positions, mesh.triangles, 1, prefilter::Run(1));
  std::vector<std::int32_t> places(mesh.positions.size(), 0);
  Facets after;
  for (std::size_t patch = 0; patch < division.count(); ++patch) {
    const PatchVertices vertices = number_vertices(division, patch, mesh.triangles, &places);
    std::set<std::int32_t> expected;
    for (const std::uint32_t t : division.triangles(patch)) {
      expected.insert(mesh.triangles[t].begin(), mesh.triangles[t].end());
    }
    EXPECT_EQ(std::set<std::int32_t>(vertices.all.begin(), vertices.all.end()), expected);
    EXPECT_EQ(vertices.all.size(), expected.size());
    for (std::size_t i = 0; i < vertices.all.size(); ++i) {
      EXPECT_EQ(division.owners[as_index(vertices.all[i])] == PatchDivision::kShared,
                i < vertices.shared);
    }
    const PatchFrame frame = {{1.0, 2.0, 3.0}, 0.25};
    Patch made;
    take_triangles(before, division, patch, vertices, places, frame, &made);
    made.triangles.front().corners.fill(7);  // removed
    Facets some = facets_of(made, vertices.all, frame, true, true);
    append(&some, &after);
    EXPECT_TRUE(some.triangles.empty());
  }
  ASSERT_EQ(after.triangles.size(), before.triangles.size() - division.count());
  const auto points_of = [](const Facets& facets, std::size_t t) {
    std::set<std::pair<double, double>> points;
    for (std::size_t p = t == 0 ? 0 : facets.point_ends[t - 1]; p < facets.point_ends[t]; ++p) {
      points.insert({facets.points[p][0], facets.points[p][1]});
    }
    return points;
  };
  for (std::size_t t = 0; t < after.triangles.size(); ++t) {
    const std::size_t was = as_index(after.labels[t]);
    EXPECT_EQ(after.triangles[t], before.triangles[was]);
    EXPECT_EQ(after.creases[t], before.creases[was]);
    EXPECT_EQ(after.errors[t], before.errors[was]);
    EXPECT_EQ(after.deviations[t], before.deviations[was]);
    EXPECT_EQ(after.crease_errors[t], before.crease_errors[was]);
    EXPECT_EQ(points_of(after, t), points_of(before, was));
  }
}

TEST(Facets, HaveCreasesAtBendsAndLabelBorders) {
  // A roof of four rows: flat, 14 degrees up, 16 degrees steeper, and flat with another label.
  constexpr int kAlong = 5;
  const std::vector<Vector3> profile = {{0, 0, 0},
                                        {0, 1, 0},
                                        {0, 1.970296, 0.241922},
                                        {0, 2.836321, 0.741922},
                                        {0, 3.702347, 1.241922}};
  Patch patch;
  std::vector<std::int32_t> vertices;
  for (int i = 0; i <= kAlong; ++i) {
    for (const Vector3& p : profile) {
      vertices.push_back(static_cast<std::int32_t>(vertices.size()));
      patch.positions.push_back(p + Vector3{static_cast<double>(i), 0, 0});
    }
  }
  patch.flags.assign(vertices.size(), 0);
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < 4; ++j) {
      const std::int32_t a = 5 * i + j;
      for (const Triangle& corners : {Triangle{a, a + 5, a + 6}, {a, a + 6, a + 1}}) {
        patch.triangles.emplace_back();
        patch.triangles.back().corners = corners;
        patch.triangles.back().label = j == 3 ? 1 : 0;
      }
    }
  }
  const auto columns = [&](Patch made, const std::vector<VertexKind>& kinds) {
    find_creases(kinds, vertices, &made);
    std::map<std::int32_t, int> counts;  // of the lines along x
    for (const PatchTriangle& t : made.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        if (((t.creases >> i) & 1U) == 0) continue;
        const std::int32_t from = t.corners[i] % 5;
        EXPECT_EQ(from, t.corners[(i + 1) % 3] % 5);
        ++counts[from];
      }
    }
    return counts;
  };
  const std::map<std::int32_t, int> of_labels = {{3, 2 * kAlong}};
  const std::map<std::int32_t, int> of_both = {{2, 2 * kAlong}, {3, 2 * kAlong}};
  EXPECT_EQ(columns(patch, {}), of_labels);
  std::vector<VertexKind> kinds(vertices.size(), VertexKind::kEdge);
  EXPECT_EQ(columns(patch, kinds), of_both);
  for (std::size_t v = 2; v < kinds.size(); v += 5) kinds[v] = VertexKind::kSurface;
  EXPECT_EQ(columns(patch, kinds), of_labels);
  for (PatchTriangle& t : patch.triangles) t.label = t.label == 1 ? kNoLabel : 0;
  EXPECT_TRUE(columns(patch, kinds).empty());
  // Corners stay, except where a crease passes through them.
  kinds.assign(vertices.size(), VertexKind::kCorner);
  Patch made = patch;
  find_creases(kinds, vertices, &made);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const bool is_on_crease = v % 5 == 2 && v > 5 && v < 25;
    // Each side of a crease counts for the vertex at its start.
    EXPECT_EQ((made.flags[v] & Patch::kFixed) == 0, is_on_crease) << v;
  }
}

}  // namespace
}  // namespace prefilter
