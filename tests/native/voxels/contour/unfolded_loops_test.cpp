// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/unfolded_loops.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <utility>
#include <vector>

#include "prefilter/voxels/contour/marching_table.h"
#include "prefilter/voxels/remesh/folds.h"

namespace prefilter {
namespace {

using Triangles = std::vector<std::array<std::int32_t, 3>>;
using Pairs = std::vector<std::array<std::uint32_t, 2>>;

// A loop around three corners of a cube, through the midpoints of its edges: (1, 3, 1) alone, and
// (3, 1, 1) with (3, 1, 3), in the order of the loop.
const std::vector<GridPlace> kPlaces = {{1, 2, 1}, {1, 3, 2}, {2, 3, 1}, {3, 2, 1},
                                        {3, 2, 3}, {2, 1, 3}, {2, 1, 1}};
// These triangles fold between the first two.
const Triangles kFolded = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {0, 4, 5}, {0, 5, 6}};

std::vector<Vector3> positions() {
  std::vector<Vector3> found;
  for (const GridPlace& place : kPlaces) {
    found.push_back({0.5 * place[0], 0.5 * place[1], 0.5 * place[2]});
  }
  return found;
}

std::map<std::pair<std::int32_t, std::int32_t>, int> sides_of(const Triangles& triangles) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> sides;
  for (const auto& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
  }
  return sides;
}

TEST(UnfoldedLoops, ALoopIsTriangulatedWithoutFolds) {
  const std::vector<Vector3> at = positions();
  const Pairs folds = folded_pairs(MeshView<std::int32_t>{at, kFolded}, 0, {}, {});
  ASSERT_EQ(folds, (Pairs{{0, 1}}));
  Triangles mended = kFolded;
  EXPECT_TRUE(unfold_loops(at, kPlaces, folds, &mended));
  EXPECT_TRUE(folded_pairs(MeshView<std::int32_t>{at, mended}, 0, {}, {}).empty());
  ASSERT_EQ(mended.size(), kFolded.size());
  const auto sides = sides_of(mended);
  const auto count = static_cast<std::int32_t>(kPlaces.size());
  for (std::int32_t v = 0; v < count; ++v) EXPECT_TRUE(sides.contains({v, (v + 1) % count}));
  for (const auto& [side, times] : sides) {
    EXPECT_EQ(times, 1);
    if (!sides.contains({side.second, side.first})) continue;
    // A diagonal runs through the cube, not within one of its faces.
    const GridPlace& a = kPlaces[static_cast<std::size_t>(side.first)];
    const GridPlace& b = kPlaces[static_cast<std::size_t>(side.second)];
    for (std::size_t k = 0; k < 3; ++k) EXPECT_FALSE(a[k] == b[k] && a[k] % 2 != 0);
  }
  EXPECT_FALSE(unfold_loops(at, kPlaces, Pairs{{0, 1}}, &mended));
}

GridPlace place_of(int edge) {
  GridPlace place;
  for (int a = 0; a < 3; ++a) {
    place[static_cast<std::size_t>(a)] = 1 + 2 * ((low_corner(edge) >> a) & 1);
  }
  place[static_cast<std::size_t>(edge / 4)] = 2;
  return place;
}

// All loops of a cube, with vertices at random positions on its edges.
TEST(UnfoldedLoops, NoDiagonalIsInAFace) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.05, 0.95);
  int changes = 0;
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<GridPlace> places;
    std::vector<Vector3> at;
    for (int edge = 0; edge < 12; ++edge) {
      places.push_back(place_of(edge));
      const auto axis = static_cast<std::size_t>(edge / 4);
      Vector3 position;
      for (std::size_t a = 0; a < 3; ++a) position[a] = 0.5 * places.back()[a];
      position[axis] = 0.5 + uniform(random);
      at.push_back(position);
    }
    for (const MarchingCase& found : marching_cases()) {
      Triangles triangles;
      for (const MarchingLoop& loop : found.loops) {
        const auto edge = [&](int i) { return loop[static_cast<std::size_t>(i)]; };
        triangulate_loop(
            static_cast<int>(loop.size()),
            [&](int i, int j) { return (faces_of_edge(edge(i)) & faces_of_edge(edge(j))) == 0U; },
            [](int, int, int) { return 1.0; },
            [&](int i, int j, int k) {
              triangles.push_back({edge(i), edge(j), edge(k)});
            });
      }
      const auto before = sides_of(triangles).size();
      const Pairs folds = folded_pairs(MeshView<std::int32_t>{at, triangles}, 0, {}, {});
      if (!unfold_loops(at, places, folds, &triangles)) continue;
      ++changes;
      EXPECT_LT(folded_pairs(MeshView<std::int32_t>{at, triangles}, 0, {}, {}).size(),
                folds.size());
      const auto sides = sides_of(triangles);
      EXPECT_EQ(sides.size(), before);
      for (const auto& [side, times] : sides) {
        if (!sides.contains({side.second, side.first})) continue;
        EXPECT_EQ(faces_of_edge(side.first) & faces_of_edge(side.second), 0U);
      }
    }
  }
  EXPECT_GT(changes, 20);
}

TEST(UnfoldedLoops, VerticesWithoutAPlaceStay) {
  const std::vector<Vector3> at = positions();
  std::vector<GridPlace> places = kPlaces;
  places[4] = kNoPlace;
  Triangles mended = kFolded;
  EXPECT_FALSE(unfold_loops(at, places, Pairs{{0, 1}}, &mended));
  EXPECT_EQ(mended, kFolded);
}

}  // namespace
}  // namespace prefilter
