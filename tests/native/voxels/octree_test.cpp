// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/octree.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/voxels/combine.h"
#include "prefilter/voxels/queries.h"
#include "prefilter/voxels/regrid.h"
#include "prefilter/voxels/remesh/intersections.h"
#include "prefilter/voxels/tree_contour.h"
#include "prefilter/voxels/voxelize.h"
#include "prefilter/wavelet/leaf_surface.h"
#include "prefilter/wavelet/refine.h"
#include "wavelet/meshes.h"
#include "wavelet/random_tree.h"

namespace prefilter {
namespace {

using testing::box_mesh;
using testing::Mesh;
using testing::sphere_mesh;

const Box kUnit = {{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};

Octree voxelized(const Mesh& mesh, int depth, std::optional<Box> bounds = kUnit) {
  std::vector<std::array<std::int64_t, 3>> triangles;
  for (const auto& t : mesh.triangles) triangles.push_back({t[0], t[1], t[2]});
  VoxelizeOptions options;
  options.depth = depth;
  options.bounds = bounds;
  return voxelize({mesh.positions, triangles}, options);
}

std::vector<float> dense(const Octree& octree) {
  return dense_values(octree, octree.depth, prefilter::Run(1));
}

std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

Octree random_octree(unsigned seed, int depth) {
  return make_octree(random_tree(seed, depth).levels, 0.0F, kUnit, depth);
}

TEST(Octree, VolumeAndBoxesAgreeWithTheDenseCells) {
  const Octree octree = random_octree(1, 4);
  const std::vector<float> cells = dense(octree);
  double sum = 0.0;
  for (const float value : cells) sum += value;
  EXPECT_NEAR(volume(octree), sum / 4096.0, 1e-9);
  // Means of split cells are stored as floats.
  EXPECT_NEAR(box_occupancy(octree, kUnit), sum / 4096.0, 1e-7);
  EXPECT_NEAR(octree.cells.root, sum / 4096.0, 1e-6);

  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-0.2, 1.2);
  for (int trial = 0; trial < 50; ++trial) {
    Box box;
    for (int a = 0; a < 3; ++a) {
      const double x = uniform(random);
      const double y = uniform(random);
      box.low[a] = std::min(x, y);
      box.high[a] = std::max(x, y);
    }
    double inside = 0.0;
    std::size_t i = 0;
    for (int x = 0; x < 16; ++x) {
      for (int y = 0; y < 16; ++y) {
        for (int z = 0; z < 16; ++z, ++i) {
          double common = 1.0;
          const std::array<int, 3> cell = {x, y, z};
          for (int a = 0; a < 3; ++a) {
            common *= std::max(0.0, std::min(box.high[a], (cell[a] + 1) / 16.0) -
                                        std::max(box.low[a], cell[a] / 16.0));
          }
          inside += common * cells[i];
        }
      }
    }
    EXPECT_NEAR(box_occupancy(octree, box), inside / box.volume(), 1e-7);
  }
}

TEST(Octree, PointsFindTheirCells) {
  const Octree octree = random_octree(5, 5);
  const std::vector<float> cells = dense(octree);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-0.1, 1.1);
  std::vector<Vector3> points = {{0, 0, 0}, {1, 1, 1}, {0.5, 0.5, 0.5}, {1.0 + 1e-9, 0.5, 0.5}};
  for (int i = 0; i < 1000; ++i)
    points.push_back({uniform(random), uniform(random), uniform(random)});
  const std::vector<float> found = values_at(octree, points, 2);
  const std::vector<std::int8_t> sides = classify(octree, points, 1e-5, 2);
  const std::vector<std::int8_t> exact_sides = classify(octree, points, 0.0, 2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    float expected = 0.0F;
    std::size_t index = 0;
    bool is_inside = true;
    for (const double x : points[i]) {
      is_inside = is_inside && x >= 0.0 && x <= 1.0;
      index = index * 32 + static_cast<std::size_t>(std::clamp(static_cast<int>(x * 32), 0, 31));
    }
    if (is_inside) expected = cells[index];
    EXPECT_EQ(found[i], expected);
    EXPECT_EQ(sides[i], expected <= 1e-5F ? -1 : expected >= 1.0F - 1e-5F ? 1 : 0);
    EXPECT_EQ(exact_sides[i], expected == 0.0F ? -1 : expected == 1.0F ? 1 : 0);
  }
}

TEST(Octree, CoarserCellsAreMeans) {
  const Octree octree = random_octree(7, 5);
  for (int depth = 0; depth < 5; ++depth) {
    EXPECT_EQ(dense_values(coarsened(octree, depth), depth, prefilter::Run(1)),
              dense_values(octree, depth, prefilter::Run(1)));
  }
}

TEST(Octree, InvalidTreesAreRefused) {
  const auto make = [](std::vector<TreeLevel> levels, int depth) {
    return message_of([&] { make_octree(levels, 0.0F, kUnit, depth); });
  };
  TreeLevel level;
  level.blocks.push_back({});
  level.split.push_back(1);
  EXPECT_NE(make({level}, 3).find("last level"), std::string::npos);
  TreeLevel leaf = level;
  leaf.split[0] = 0;
  EXPECT_EQ(make({level, leaf}, 2), "");
  EXPECT_NE(make({level, leaf}, 1).find("levels: 2"), std::string::npos);
  EXPECT_NE(make({leaf, leaf}, 3).find("nothing is split on level 0"), std::string::npos);
  leaf.blocks[0][3] = 2.0F;
  EXPECT_NE(make({leaf}, 3).find("values: found 2"), std::string::npos);
  leaf.blocks[0][3] = std::nanf("");
  EXPECT_NE(make({leaf}, 3).find("values: found nan"), std::string::npos);
}

TEST(Combine, EqualsDenseOperationsForAnyDepths) {
  for (unsigned seed = 10; seed < 20; ++seed) {
    const Octree a = random_octree(seed, 3 + static_cast<int>(seed % 3));
    const Octree b = random_octree(seed + 100, 2 + static_cast<int>(seed % 4));
    const int depth = std::max(a.depth, b.depth);
    // Leaves that are neither full nor empty are split before the comparison.
    const auto dense_refined = [&](const Octree& octree) {
      Octree fine = octree;
      fine.cells =
          refined(octree.cells, std::max(a.cells.depth(), b.cells.depth()), prefilter::Run(1));
      return dense_values(fine, depth, prefilter::Run(1));
    };
    const std::vector<float> of_a = dense_refined(a);
    const std::vector<float> of_b = dense_refined(b);
    for (const SetOperation operation :
         {SetOperation::kUnion, SetOperation::kIntersection, SetOperation::kDifference}) {
      const Octree result = combine(a, b, operation, prefilter::Run(1));
      const std::vector<float> found = dense_values(result, depth, prefilter::Run(1));
      for (std::size_t i = 0; i < found.size(); ++i) {
        const float other = operation == SetOperation::kDifference ? 1.0F - of_b[i] : of_b[i];
        const float expected =
            operation == SetOperation::kUnion ? std::max(of_a[i], other) : std::min(of_a[i], other);
        // Values of exactly 1/2 are moved by 1e-4.
        ASSERT_NEAR(found[i], expected, std::abs(expected - 0.5F) < 1e-4F ? 2e-4 : 0.0);
      }
      EXPECT_EQ(found, dense_values(combine(a, b, operation, prefilter::Run(3)), depth,
                                    prefilter::Run(1)));
    }
  }
}

TEST(Combine, UniformBlocksAreMerged) {
  const Octree box = voxelized(box_mesh({0.3, 0.3, 0.3}, {0.6, 0.6, 0.6}), 6);
  const Octree empty = combine(box, voxelized(box_mesh({0.1, 0.1, 0.1}, {0.9, 0.9, 0.9}), 6),
                               SetOperation::kDifference, prefilter::Run(1));
  EXPECT_EQ(volume(empty), 0.0);
  EXPECT_LE(empty.cells.cell_count(), 9U);
}

TEST(Combine, CoincidentFacesLeaveNoFilm) {
  // The face x = 0.53125 passes through the middle of a cell of depth 4.
  const Octree box = voxelized(box_mesh({0.1, 0.1, 0.1}, {0.53125, 0.9, 0.9}), 4);
  const Octree beside = voxelized(box_mesh({0.53125, 0.1, 0.1}, {0.9, 0.9, 0.9}), 4);
  const auto at_face = [](const Octree& octree) {
    return values_at(octree, std::vector<Vector3>{{0.53, 0.5, 0.5}}, 1)[0];
  };
  ASSERT_NEAR(at_face(box), 0.5, 1e-6);
  EXPECT_LT(at_face(combine(box, box, SetOperation::kDifference, prefilter::Run(1))), 0.5F);
  EXPECT_LT(at_face(combine(box, beside, SetOperation::kIntersection, prefilter::Run(1))), 0.5F);
  EXPECT_GT(at_face(combine(box, beside, SetOperation::kUnion, prefilter::Run(1))), 0.5F);
}

TEST(Combine, ResamplesOtherBounds) {
  const Mesh left = box_mesh({0.1, 0.1, 0.1}, {0.8, 0.8, 0.8});
  const Mesh right = box_mesh({0.5, 0.5, 0.5}, {1.8, 1.2, 1.4});
  const Octree a = voxelized(left, 6);
  // b has cells of the same size, shifted by whole cells, so that it is copied exactly.
  const Octree b = voxelized(right, 7, Box{{0.25, 0.0, 0.0}, {2.25, 2.0, 2.0}});
  const Octree both = combine(a, b, SetOperation::kIntersection, prefilter::Run(1));
  EXPECT_NEAR(volume(both), 0.3 * 0.3 * 0.3, 2e-3);
  EXPECT_EQ(both.bounds.high[0], 1.0);
  const Octree joined = combine(a, b, SetOperation::kUnion, prefilter::Run(1));
  EXPECT_NEAR(volume(joined), volume(a) + volume(b) - 0.027, 4e-3);
  EXPECT_GE(joined.bounds.high[0], 1.8);
  EXPECT_EQ(joined.cell_size(0, joined.depth), a.cell_size(0, a.depth));
  const Octree cut = combine(a, b, SetOperation::kDifference, prefilter::Run(1));
  EXPECT_NEAR(volume(cut), volume(a) - 0.027, 2e-3);
}

TEST(Combine, ContoursDoNotIntersectThemselves) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int trial = 0; trial < 12; ++trial) {
    const Vector3 middle = {0.3 + 0.4 * uniform(random), 0.3 + 0.4 * uniform(random), 0.4};
    const double radius = 0.15 + 0.2 * uniform(random);
    const Vector3 low = {0.1 + 0.4 * uniform(random), 0.1 + 0.4 * uniform(random), 0.2};
    const Vector3 size = {0.2 + 0.3 * uniform(random), 0.2 + 0.3 * uniform(random), 0.41};
    Box bounds = kUnit;
    if (trial % 3 == 0) bounds = {{-0.1, -0.13, -0.05}, {1.17, 1.04, 1.1}};
    const Octree ball = voxelized(sphere_mesh(middle, radius, 20), 3 + trial % 4);
    const Octree box = voxelized(box_mesh(low, low + size), 6 - trial % 3, bounds);
    for (const SetOperation operation :
         {SetOperation::kUnion, SetOperation::kIntersection, SetOperation::kDifference}) {
      const Octree both = combine(ball, box, operation, prefilter::Run(1));
      for (const Interpolant interpolant : {Interpolant::kOccupancy, Interpolant::kPlane}) {
        ContourOptions options;
        options.interpolant = interpolant;
        options.clean_up = false;
        const TriangleMesh mesh = contour_tree(both.cells, both.bounds, options);
        EXPECT_TRUE(
            intersecting_triangles({mesh.positions, mesh.triangles}, {}, prefilter::Run(1)).empty())
            << trial;
      }
    }
  }
}

TEST(Resample, KeepsTheVolume) {
  const Box around = {{-0.31, -0.17, -0.4}, {1.2, 1.33, 1.11}};
  const Octree ball = voxelized(sphere_mesh({0.5, 0.5, 0.45}, 0.4, 20), 4);
  EXPECT_EQ(dense(regridded(ball, kUnit, 4, prefilter::Run(1))), dense(ball));
  // The surface is assumed to be flat within each cell.
  EXPECT_NEAR(volume(regridded(ball, around, 4, prefilter::Run(1))), volume(ball), 1e-5);
  const Octree noise = random_octree(30, 4);
  EXPECT_NEAR(volume(regridded(noise, around, 4, prefilter::Run(1))), volume(noise), 5e-5);
}

// Whether a leaf above the finest depth has a neighbor with another value, by the dense cells.
bool is_beside_a_border(const Octree& octree, const std::vector<float>& cells, int level,
                        std::array<int, 3> place) {
  const int n = 1 << octree.depth;
  const int width = n >> level;
  std::array<int, 3> low;
  std::array<int, 3> high;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::max(place[a] * width - 1, 0);
    high[a] = std::min((place[a] + 1) * width + 1, n);
  }
  const auto at = [&](int x, int y, int z) {
    return cells[(static_cast<std::size_t>(x) * n + static_cast<std::size_t>(y)) * n + z];
  };
  for (int z = low[2]; z < high[2]; ++z) {
    for (int y = low[1]; y < high[1]; ++y) {
      for (int x = low[0]; x < high[0]; ++x) {
        if (at(x, y, z) != at(low[0], low[1], low[2])) return true;
      }
    }
  }
  return false;
}

TEST(Resample, CellsOnBothSidesOfABorderAreFine) {
  // Faces lie on cell borders before and after, so that all cells are uniform.
  const Octree box = voxelized(box_mesh({0.25, 0.5, 0.125}, {0.75, 1.0, 0.5}), 5);
  const Octree made = regridded(box, {{-0.5, -0.5, -0.5}, {1.5, 1.5, 1.5}}, 6, prefilter::Run(1));
  const std::vector<float> cells = dense(made);
  ASSERT_EQ(volume(made), volume(box));
  const auto visit = [&](const auto& self, int level, std::size_t block,
                         std::array<int, 3> place) -> void {
    const TreeLevel& blocks = made.cells.levels[static_cast<std::size_t>(level)];
    for (int o = 0; o < 8; ++o) {
      const std::array<int, 3> octant = {2 * place[0] + (o & 1), 2 * place[1] + ((o >> 1) & 1),
                                         2 * place[2] + (o >> 2)};
      if (blocks.is_split(block, o)) {
        self(self, level + 1, blocks.child(block, o), octant);
      } else if (level + 1 < made.depth) {
        EXPECT_FALSE(is_beside_a_border(made, cells, level + 1, octant));
      }
    }
  };
  visit(visit, 0, 0, {0, 0, 0});
}

TEST(Resample, GridsEqualUpToRoundingHaveTheSameCells) {
  const Octree ball = voxelized(sphere_mesh({0.5, 0.5, 0.45}, 0.4, 20), 5);
  for (const double shift : {-1e-13, 1e-13}) {
    const Box nearly = {{shift, shift, shift}, {1.0 + shift, 1.0 + shift, 1.0 + shift}};
    const Octree made = regridded(ball, nearly, 5, prefilter::Run(1));
    const Octree same = regridded(ball, kUnit, 5, prefilter::Run(1));
    EXPECT_EQ(made.cells.cell_count(), same.cells.cell_count());
  }
}

TEST(Resample, MovesPlanesExactly) {
  const Mesh half = box_mesh({-1.0, -1.0, -1.0}, {2.0, 2.0, 0.4371});
  const Box around = {{-0.31, -0.17, -0.37}, {1.2, 1.33, 1.13}};
  const Octree moved = regridded(voxelized(half, 4), around, 5, prefilter::Run(1));
  const Box within = {{0.2, 0.2, 0.2}, {0.8, 0.8, 0.7}};
  EXPECT_NEAR(box_occupancy(moved, within), (0.4371 - 0.2) / 0.5, 1e-6);
  int fractions = 0;
  for (const TreeLevel& level : moved.cells.levels) {
    for (std::size_t b = 0; b < level.size(); ++b) {
      for (int o = 0; o < 8; ++o) {
        const float value = level.blocks[b][static_cast<std::size_t>(o)];
        if (!level.is_split(b, o) && is_fraction(value)) ++fractions;
      }
    }
  }
  // One layer of cells over the source's root, and the cells its borders cut.
  EXPECT_LT(fractions, 32 * 32 + 6 * 32 * 32);
}

TEST(Voxelize, LeavesAMarginAroundTheMesh) {
  const Mesh mesh = sphere_mesh({3.0, -2.0, 1.0}, 2.0, 20);
  for (const int depth : {1, 2, 3, 4, 8}) {
    const Octree octree = voxelized(mesh, depth, std::nullopt);
    const double margin = octree.cell_size(0, depth) * std::min(2.0, std::ldexp(0.125, depth));
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(octree.bounds.size(a), octree.bounds.size(0), 1e-12);
    EXPECT_NEAR(octree.bounds.high[2] - 3.0, margin, 1e-9);
    EXPECT_NEAR(volume(octree) / (std::numbers::pi * 32.0 / 3.0), 1.0, 0.02);
  }
}

TEST(Voxelize, ReportsInvalidArguments) {
  const std::vector<Vector3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}};
  using Triangles = std::vector<std::array<std::int64_t, 3>>;
  const auto message = [&](const std::vector<Vector3>& positions, const Triangles& triangles,
                           const VoxelizeOptions& options) {
    return message_of([&] { voxelize({positions, triangles}, options); });
  };
  EXPECT_NE(message(corners, {}, {}).find("triangles: none"), std::string::npos);
  EXPECT_NE(message(corners, {{0, 1, 4}}, {}).find("names vertex 4"), std::string::npos);
  EXPECT_NE(message(corners, {{0, 1, 3}}, {}).find("zero area"), std::string::npos);
  EXPECT_NE(message(corners, {{1, 1, 1}}, {}).find("zero area"), std::string::npos);
  EXPECT_NE(message({{0, 0, NAN}}, {{0, 0, 0}}, {}).find("vertex 0 holds nan"), std::string::npos);
  VoxelizeOptions deep;
  deep.depth = 13;
  EXPECT_NE(message(corners, {{0, 1, 2}}, deep).find("depth: 13"), std::string::npos);
  VoxelizeOptions flat;
  flat.bounds = Box{{0, 0, 0}, {1, 1, 0}};
  EXPECT_NE(message(corners, {{0, 1, 2}}, flat).find("bounds: from 0 to 0 along z"),
            std::string::npos);
}

TEST(Voxelize, RefusesTooManyCells) {
  Mesh sheets;
  for (int i = 0; i < 20000; ++i) {
    const double z = 0.1 + 4e-5 * i;
    Mesh sheet;
    sheet.positions = {{0, 0, z}, {2, 0, z}, {0, 2, z}};
    sheet.triangles = {{0, 1, 2}};
    sheets.add(sheet);
  }
  try {
    voxelized(sheets, 12);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory);
    EXPECT_NE(std::string(error.what()).find("depth 12"), std::string::npos);
  }
}

}  // namespace
}  // namespace prefilter
