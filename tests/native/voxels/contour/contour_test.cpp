// SPDX-License-Identifier: GPL-3.0-or-later

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "prefilter/base/error.h"
#include "prefilter/voxels/contour/edge_crossing.h"
#include "prefilter/voxels/contour/height_crossing.h"
#include "prefilter/voxels/contour/marching_table.h"
#include "prefilter/voxels/grid_contour.h"
#include "prefilter/voxels/remesh/intersections.h"
#include "prefilter/voxels/tree_contour.h"
#include "voxels/contour/half_planes.h"
#include "voxels/contour/mesh_checks.h"
#include "wavelet/random_tree.h"

namespace prefilter {
namespace {

using testing::fault_of;
using testing::share_below;
using testing::volume_of;

constexpr Box kUnitBox = {{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};

constexpr std::array<Interpolant, 3> kInterpolants = {Interpolant::kOccupancy, Interpolant::kPlane,
                                                      Interpolant::kLinear};

ContourOptions options_of(Interpolant interpolant, int threads = 1) {
  ContourOptions options;
  options.interpolant = interpolant;
  options.clean_up = false;
  options.run = prefilter::Run(threads);
  return options;
}

TEST(EdgeCrossing, IsExactForLines) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int count = 0;
  while (count < 20000) {
    const double a = uniform(random);
    const double b = uniform(random);
    // A line through the segment between the centers (1/2, 1/2) and (3/2, 1/2).
    const double t = std::abs(uniform(random));
    const double c = a * (0.5 + t) + b * 0.5;
    const double first = share_below(0.0, 0.0, a, b, c);
    const double second = share_below(1.0, 0.0, a, b, c);
    if ((first < 0.5) == (second < 0.5) || std::abs(first - second) < 1e-3) continue;
    ++count;
    ASSERT_NEAR(occupancy_crossing(static_cast<float>(first), static_cast<float>(second)), t,
                1e-4 / std::abs(first - second) * 1e-1)
        << first << " " << second;
  }
}

TEST(EdgeCrossing, IsBetweenFullAndEmptyCells) {
  EXPECT_EQ(occupancy_crossing(0.0F, 1.0F), 0.5F);
  EXPECT_EQ(occupancy_crossing(1.0F, 0.0F), 0.5F);
  EXPECT_EQ(occupancy_crossing(0.0F, 0.5F), 1.0F);
  EXPECT_EQ(occupancy_crossing(0.5F, 0.0F), 0.0F);
  EXPECT_EQ(linear_crossing(0.0F, 1.0F, 0.25F), 0.25F);
}

TEST(MarchingCases, AllLoopsAreTriangulatedWithoutDiagonalsInFaces) {
  for (unsigned inside = 0; inside < 256; ++inside) {
    const MarchingCase& found = marching_cases()[inside];
    std::size_t triangles = 0;
    std::array<int, 12> uses{};
    for (const MarchingLoop& loop : found.loops) {
      triangles += loop.size() - 2;
      for (const int edge : loop) ++uses[static_cast<std::size_t>(edge)];
    }
    std::vector<std::array<int, 3>> found_triangles;
    for (const MarchingLoop& loop : found.loops) {
      const auto edge = [&](int i) { return loop[static_cast<std::size_t>(i)]; };
      EXPECT_TRUE(triangulate_loop(
          static_cast<int>(loop.size()),
          [&](int i, int j) { return (faces_of_edge(edge(i)) & faces_of_edge(edge(j))) == 0U; },
          [](int, int, int) { return 1.0; },
          [&](int i, int j, int k) {
            found_triangles.push_back({edge(i), edge(j), edge(k)});
          }));
    }
    EXPECT_EQ(found_triangles.size(), triangles);
    for (int edge = 0; edge < 12; ++edge) {
      const bool is_cut =
          (((inside >> low_corner(edge)) ^ (inside >> high_corner(edge))) & 1U) != 0U;
      EXPECT_EQ(uses[static_cast<std::size_t>(edge)], is_cut ? 1 : 0);
    }
    std::map<std::pair<int, int>, int> sides;
    for (const auto& t : found_triangles) {
      for (std::size_t i = 0; i < 3; ++i) ++sides[{t[i], t[(i + 1) % 3]}];
    }
    for (const auto& [side, count] : sides) {
      EXPECT_EQ(count, 1);
      const bool is_diagonal = sides.contains({side.second, side.first});
      if (is_diagonal) {
        EXPECT_EQ(faces_of_edge(side.first) & faces_of_edge(side.second), 0U);
      }
    }
  }
}

// All pairs of cubes that share a face occur, and grids of many sizes.
TEST(ContourGrid, RandomSamplesGiveClosedManifolds) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  const std::vector<std::array<int, 3>> sizes = {{1, 1, 1}, {2, 1, 3}, {5, 5, 5}, {9, 4, 6}};
  for (int trial = 0; trial < 120; ++trial) {
    GridView grid;
    grid.size = sizes[static_cast<std::size_t>(trial) % sizes.size()];
    std::vector<float> values(static_cast<std::size_t>(grid.size[0] * grid.size[1] * grid.size[2]));
    for (float& value : values) {
      value = uniform(random);
      if (trial % 3 == 1) value = std::round(value);
      if (trial % 3 == 2) value = std::round(4.0F * value) / 4.0F;  // includes exactly 1/2
    }
    grid.values = values.data();
    for (const Interpolant interpolant : kInterpolants) {
      ASSERT_EQ(fault_of(contour_grid(grid, {}, options_of(interpolant))), "") << trial;
    }
  }
}

// Positions in lexicographic order, relative to `low`.
std::vector<Vector3> sorted_positions(const TriangleMesh& mesh, int low) {
  std::vector<Vector3> positions = mesh.positions;
  for (auto& p : positions) {
    for (double& x : p) x -= low;
  }
  std::sort(positions.begin(), positions.end());
  return positions;
}

// Whether one of the sorted positions equals p up to rounding.
bool has_near(const std::vector<Vector3>& sorted, const Vector3& p) {
  constexpr double kNear = 1e-5;
  auto at = std::lower_bound(sorted.begin(), sorted.end(),
                             std::array{p[0] - kNear, p[1] - kNear, p[2] - kNear});
  for (; at != sorted.end() && (*at)[0] <= p[0] + kNear; ++at) {
    if (std::abs((*at)[1] - p[1]) <= kNear && std::abs((*at)[2] - p[2]) <= kNear) return true;
  }
  return false;
}

// Repeating each sample in a block leaves a grid whose contour moves with the blocks.
TEST(ContourGrid, MovesWithItsSamples) {
  constexpr int kBlock = 4;
  constexpr int kBlocks = 3;
  constexpr int kSize = 32;
  std::mt19937 random(8);
  for (int trial = 0; trial < 4; ++trial) {
    std::vector<float> blocks(kBlocks * kBlocks * kBlocks);
    for (float& block : blocks) block = static_cast<float>(random() % 5) / 4.0F;
    for (const Interpolant interpolant : kInterpolants) {
      std::vector<Vector3> first;
      std::size_t triangles = 0;
      for (const int low : {8, 9, 11, 12, 16}) {
        std::vector<float> values(kSize * kSize * kSize);
        GridView grid{values.data(), {kSize, kSize, kSize}};
        constexpr int kSide = kBlock * kBlocks;
        for (int i = 0; i < kSide * kSide * kSide; ++i) {
          const std::array<int, 3> at = {i / (kSide * kSide), i / kSide % kSide, i % kSide};
          values[grid.index(low + at[0], low + at[1], low + at[2])] =
              blocks[static_cast<std::size_t>(
                  (at[0] / kBlock * kBlocks + at[1] / kBlock) * kBlocks + at[2] / kBlock)];
        }
        const TriangleMesh mesh = contour_grid(grid, {}, options_of(interpolant));
        ASSERT_EQ(fault_of(mesh), "");
        const auto positions = sorted_positions(mesh, low);
        if (low == 8) {
          first = positions;
          triangles = mesh.triangles.size();
        }
        ASSERT_EQ(mesh.triangles.size(), triangles) << trial << " " << low;
        ASSERT_EQ(positions.size(), first.size()) << trial << " " << low;
        for (const auto& p : positions) {
          ASSERT_TRUE(has_near(first, p)) << trial << " " << low;
        }
      }
    }
  }
}

TEST(ContourGrid, FullBoxesLoseOnlyTheirEdges) {
  // Planes through the middles between samples cut off 1/8 of a cell along each edge, and 5/48 at
  // each corner.
  for (const auto& [low, side, size] : std::vector<std::array<int, 3>>{
           {0, 4, 8}, {4, 4, 16}, {4, 8, 16}, {8, 16, 32}, {3, 4, 9}, {0, 5, 5}}) {
    std::vector<float> values(static_cast<std::size_t>(size) * size * size);
    GridView grid{values.data(), {size, size, size}};
    for (int i = 0; i < side * side * side; ++i) {
      values[grid.index(low + i / (side * side), low + i / side % side, low + i % side)] = 1.0F;
    }
    const double wanted = side * side * side - 12 * (side - 1) / 8.0 - 8 * 5 / 48.0;
    for (const Interpolant interpolant : kInterpolants) {
      const TriangleMesh mesh = contour_grid(grid, {}, options_of(interpolant));
      EXPECT_EQ(fault_of(mesh), "");
      EXPECT_NEAR(volume_of(mesh), wanted, 1e-3) << low << " " << side << " " << size;
      EXPECT_EQ(mesh.positions.size(), 6U * side * side);
    }
  }
}

// For functions with a sign, the values that pad a grid to a cube must be outside as well.
TEST(ContourGrid, TakesIsoValuesOfZeroAndBelow) {
  for (const int size : {16, 20}) {
    for (const float isovalue : {0.0F, -0.5F}) {
      std::vector<float> values;
      for (int i = 0; i < size * size * size; ++i) {
        const double middle = size / 2.0 - 0.5;
        values.push_back(
            static_cast<float>(5.0 - std::hypot(i / (size * size) - middle,
                                                i / size % size - middle, i % size - middle)));
      }
      ContourOptions options = options_of(Interpolant::kLinear);
      options.isovalue = isovalue;
      const TriangleMesh mesh = contour_grid({values.data(), {size, size, size}}, {}, options);
      EXPECT_EQ(fault_of(mesh), "");
      const double radius = 5.0 - static_cast<double>(isovalue);
      EXPECT_NEAR(volume_of(mesh) / (4.18879 * radius * radius * radius), 1.0, 0.025);
      // With all samples inside, the surface runs around the grid and is finite.
      options.isovalue = -100.0F;
      const TriangleMesh all = contour_grid({values.data(), {size, size, size}}, {}, options);
      EXPECT_EQ(fault_of(all), "");
      EXPECT_GT(volume_of(all), 0.9 * size * size * size);
    }
  }
  const std::vector<float> zeros(27, 0.0F);
  ContourOptions options;
  options.isovalue = 0.0F;
  EXPECT_EQ(fault_of(contour_grid({zeros.data(), {3, 3, 3}}, {}, options)), "");
}

TEST(ContourTree, LeavesOfAnySizesGiveClosedManifolds) {
  for (unsigned seed = 0; seed < 80; ++seed) {
    const CellTree tree = random_tree(seed, 1 + static_cast<int>(seed % 5));
    for (const Interpolant interpolant : kInterpolants) {
      ContourOptions options = options_of(interpolant);
      options.clean_up = seed % 4 == 3;
      ASSERT_EQ(fault_of(contour_tree(tree, kUnitBox, options)), "") << seed;
    }
  }
}

TEST(ContourOccupancies, NeverCrossesItself) {
  for (unsigned seed = 0; seed < 16; ++seed) {
    const CellTree tree = random_tree(seed, 2 + static_cast<int>(seed % 4));
    for (const Interpolant interpolant : kInterpolants) {
      const TriangleMesh mesh = contour_occupancies(tree, kUnitBox, options_of(interpolant));
      EXPECT_EQ(fault_of(mesh), "");
      EXPECT_TRUE(
          intersecting_triangles({mesh.positions, mesh.triangles}, {}, prefilter::Run(1)).empty())
          << seed;
    }
  }
}

// Cosine of the largest angle between two adjacent triangles.
double least_cosine(const TriangleMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, Vector3> normals;
  for (const auto& t : mesh.triangles) {
    const auto at = [&](std::size_t k) { return mesh.positions[static_cast<std::size_t>(t[k])]; };
    const Vector3 normal = cross(at(1) - at(0), at(2) - at(0));
    for (std::size_t k = 0; k < 3; ++k) normals[{t[k], t[(k + 1) % 3]}] = normal;
  }
  double least = 1.0;
  for (const auto& [side, normal] : normals) {
    const Vector3& other = normals.at({side.second, side.first});
    least = std::min(least, dot(normal, other) / (length(normal) * length(other)));
  }
  return least;
}

// Cells with random values have all kinds of gaps between them.
TEST(ContourOccupancies, NeverFolds) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const CellTree tree = random_tree(seed, 2 + static_cast<int>(seed % 4));
    const TriangleMesh mesh = contour_occupancies(tree, kUnitBox, options_of(Interpolant::kPlane));
    EXPECT_EQ(fault_of(mesh), "");
    EXPECT_GT(least_cosine(mesh), -0.5001) << seed;
    EXPECT_TRUE(
        intersecting_triangles({mesh.positions, mesh.triangles}, {}, prefilter::Run(1)).empty())
        << seed;
  }
}

TEST(ContourTree, HasNoZeroAreaFarFromTheOrigin) {
  const CellTree tree = random_tree(7, 5);
  const Box root{{1000.0, -2000.0, 500.0}, {1001.0, -1998.0, 500.5}};
  EXPECT_EQ(fault_of(contour_tree(tree, root, options_of(Interpolant::kOccupancy))), "");
}

// Positions relative to the root stay distinct when rounded to floats, as files and Blender store
// them.
TEST(ContourTree, HasNoZeroAreaInFloats) {
  for (const double low : {0.0, -0.5}) {
    const CellTree tree = random_tree(12, 6);
    const Box root{{low, low, low}, {low + 1.0, low + 1.0, low + 1.0}};
    TriangleMesh mesh = contour_tree(tree, root, options_of(Interpolant::kOccupancy));
    for (Vector3& p : mesh.positions) {
      for (double& x : p) x = static_cast<double>(static_cast<float>(x));
    }
    EXPECT_EQ(fault_of(mesh), "");
  }
}

// Clean Up works on the final positions, so that these decide which triangles change.
TEST(ContourTree, IsManifoldForAnyRootWithCleanUp) {
  const CellTree tree = random_tree(9, 4);
  ContourOptions options = options_of(Interpolant::kPlane);
  const double raw = static_cast<double>(contour_tree(tree, kUnitBox, options).triangles.size());
  options.clean_up = true;
  for (const auto& [low, size] : std::vector<std::pair<double, double>>{
           {0.0, 1.0}, {1e5, 1.0}, {-3e9, 2.0}, {-0.5, 1e39}, {0.0, 1e290}, {1e-30, 1e-39}}) {
    const Box root{{low, low, low}, {low + size, low + size, low + size}};
    TriangleMesh mesh = contour_tree(tree, root, options);
    EXPECT_LT(static_cast<double>(mesh.triangles.size()), raw) << low << " " << size;
    for (Vector3& p : mesh.positions) {
      for (double& x : p) x = (x - low) / root.size(0);
    }
    EXPECT_EQ(fault_of(mesh), "") << low << " " << size;
  }
}

// The surface is the same far from the origin and at any scale, while doubles there are precise
// enough to separate vertices from samples.
TEST(ContourTree, MovesWithItsRoot) {
  const CellTree tree = random_tree(9, 4);
  for (const Interpolant interpolant : kInterpolants) {
    const ContourOptions options = options_of(interpolant);
    const TriangleMesh wanted = contour_tree(tree, kUnitBox, options);
    for (const auto& [low, size] : std::vector<std::pair<double, double>>{
             {1e5, 1.0}, {-1e9, 2.0}, {-0.5, 1e39}, {0.0, 1e290}, {1e-30, 1e-39}}) {
      const Box root{{low, low, low}, {low + size, low + size, low + size}};
      const TriangleMesh mesh = contour_tree(tree, root, options);
      ASSERT_EQ(mesh.triangles, wanted.triangles) << low << " " << size;
      TriangleMesh back = mesh;
      double worst = 0.0;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        for (std::size_t a = 0; a < 3; ++a) {
          back.positions[v][a] = (mesh.positions[v][a] - low) / root.size(0);
          worst = std::max(worst, std::abs(back.positions[v][a] - wanted.positions[v][a]));
        }
      }
      EXPECT_LT(worst, 1e-15 + 1e-15 * std::abs(low) / size) << low << " " << size;
      EXPECT_EQ(fault_of(back), "") << low << " " << size;
    }
  }
}

TEST(ContourTree, NeedsARootWithCells) {
  const CellTree tree = random_tree(3, 2);
  EXPECT_THROW(contour_tree(tree, Box{}, {}), Error);
  EXPECT_THROW(contour_tree(tree, Box{{1e20, 0.0, 0.0}, {1e20 + 1e5, 1.0, 1.0}}, {}), Error);
  EXPECT_THROW(contour_tree(tree, Box{{0.0, 0.0, 0.0}, {INFINITY, 1.0, 1.0}}, {}), Error);
}

TEST(ContourTree, ThreadsDoNotChangeTheResult) {
  const CellTree tree = random_tree(11, 6);
  for (const Interpolant interpolant : kInterpolants) {
    const TriangleMesh one = contour_tree(tree, kUnitBox, options_of(interpolant, 1));
    const TriangleMesh three = contour_tree(tree, kUnitBox, options_of(interpolant, 3));
    EXPECT_EQ(one.positions, three.positions);
    EXPECT_EQ(one.triangles, three.triangles);
  }
}

// The package uses the options in this way.
TEST(ContourOptions, DefaultToSharpForTreesAndOccupancyForGrids) {
  const CellTree tree = random_tree(4, 4);
  ContourOptions sharp = options_of(Interpolant::kSharp);
  sharp.clean_up = true;
  const TriangleMesh whole = contour_tree(tree, kUnitBox, {});
  EXPECT_EQ(whole.positions, contour_tree(tree, kUnitBox, sharp).positions);
  const std::vector<float> values = {0.0F, 0.9F, 0.3F, 0.6F, 0.7F, 1.0F, 0.4F, 0.1F};
  const GridView grid{values.data(), {2, 2, 2}};
  ContourOptions occupancy = options_of(Interpolant::kOccupancy);
  occupancy.clean_up = true;
  EXPECT_EQ(contour_grid(grid, {}, {}).positions, contour_grid(grid, {}, occupancy).positions);
}

TEST(ContourTree, FullAndEmptyRoots) {
  CellTree tree;
  EXPECT_TRUE(contour_tree(tree, kUnitBox, {}).triangles.empty());
  tree.root = 1.0F;
  const TriangleMesh cube = contour_tree(tree, kUnitBox, options_of(Interpolant::kOccupancy));
  EXPECT_EQ(fault_of(cube), "");
  // The faces of the root, minus the parts cut off at its edges and corners.
  EXPECT_NEAR(volume_of(cube), 17.0 / 24.0, 1e-6);
  ContourOptions stop;
  stop.run = prefilter::Run([](double) { return false; });
  EXPECT_THROW(contour_tree(tree, kUnitBox, stop), Error);
}

// Share of the unit cell below the plane n . p = d, for n >= 0, by inclusion and exclusion.
double share_below(const Vector3& n, double d) {
  if (d <= 0.0) return 0.0;
  if (d >= n[0] + n[1] + n[2]) return 1.0;
  double sum = 0.0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    double rest = d;
    for (unsigned a = 0; a < 3; ++a) rest -= ((corner >> a) & 1U) != 0U ? n[a] : 0.0;
    const double cube = std::pow(std::max(rest, 0.0), 3);
    sum += std::popcount(corner) % 2 == 0 ? cube : -cube;
  }
  return sum / (6.0 * n[0] * n[1] * n[2]);
}

TEST(ContourGrid, PlaneReproducesPlanes) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  constexpr int kSize = 14;
  Vector3 mean{};
  std::size_t count = 0;
  for (int trial = 0; trial < 40; ++trial) {
    Vector3 n = {normal(random), normal(random), normal(random)};
    const double length = std::hypot(n[0], n[1], n[2]);
    for (double& x : n) x /= length;
    if (std::min({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])}) < 0.02) continue;
    double d = 0.0;
    for (const double x : n) d += x * (kSize / 2.0 + uniform(random));
    std::vector<float> values;
    for (int i = 0; i < kSize * kSize * kSize; ++i) {
      const std::array<int, 3> cell = {i / (kSize * kSize), i / kSize % kSize, i % kSize};
      Vector3 facing;
      double rest = d;
      for (std::size_t a = 0; a < 3; ++a) {
        facing[a] = std::abs(n[a]);
        rest -= n[a] * (n[a] > 0.0 ? cell[a] : cell[a] + 1.0);
      }
      values.push_back(static_cast<float>(share_below(facing, rest)));
    }
    const GridView grid{values.data(), {kSize, kSize, kSize}};
    for (std::size_t i = 0; i < 3; ++i) {
      const TriangleMesh mesh = contour_grid(grid, {}, options_of(kInterpolants[i]));
      for (const auto& p : mesh.positions) {
        double off = -d;
        bool is_inner = true;
        for (std::size_t a = 0; a < 3; ++a) {
          off += n[a] * p[a];
          is_inner = is_inner && p[a] > 4.0 && p[a] < kSize - 4.0;
        }
        if (!is_inner) continue;
        mean[i] += std::abs(off);
        if (i == 0) ++count;
        if (kInterpolants[i] == Interpolant::kPlane) {
          ASSERT_LT(std::abs(off), 3e-5);
        }
      }
    }
  }
  ASSERT_GT(count, 1000U);
  EXPECT_LT(mean[1] / static_cast<double>(count), 2e-6);  // plane
  EXPECT_LT(mean[0], mean[2] / 20.0);                     // occupancy compared with linear
}

TEST(HeightCrossing, IsOfFourthOrderAcrossAParabola) {
  // Columns of cells below the surface z = 7.3 + x^2 k / 2, whose means have a closed form.
  constexpr int kSize = 16;
  const double k = 0.05;
  std::vector<float> values(kSize * kSize * kSize);
  const auto mean_height = [&](double x) { return 7.3 + k / 2.0 * (x * x + 1.0 / 12.0); };
  for (int i = 0; i < kSize * kSize * kSize; ++i) {
    const int x = i / (kSize * kSize);
    const int z = i % kSize;
    // Between full and empty cells only the sum of the column counts.
    values[static_cast<std::size_t>(i)] =
        static_cast<float>(std::clamp(mean_height(x - 7.5) - z, 0.0, 1.0));
  }
  const std::array<std::ptrdiff_t, 3> strides = {kSize * kSize, kSize, 1};
  for (int x = 7; x <= 9; ++x) {
    const float* cell = values.data() + x * kSize * kSize + 8 * kSize + 6;
    const std::optional<float> t = height_crossing(cell, strides, 5);
    ASSERT_TRUE(t);
    EXPECT_NEAR(6.5 + *t, 7.3 + k / 2.0 * (x - 7.5) * (x - 7.5), 1e-5);
  }
}

TEST(HeightCrossing, IsNoneWithoutData) {
  std::vector<float> values(16 * 16 * 16, 0.4F);
  values[7 * 256 + 8 * 16 + 8] = 0.6F;
  const std::array<std::ptrdiff_t, 3> strides = {256, 16, 1};
  EXPECT_FALSE(height_crossing(values.data() + 7 * 256 + 8 * 16 + 8, strides, 1));
}

TEST(ContourGrid, ReportsInvalidArguments) {
  std::vector<float> values(8, 0.5F);
  values[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(contour_grid({values.data(), {2, 2, 2}}, {}, {}), Error);
  EXPECT_THROW(contour_grid({values.data(), {0, 2, 2}}, {}, {}), Error);
  EXPECT_THROW(contour_grid({values.data(), {5000, 1, 1}}, {}, {}), Error);
  values[3] = 0.5F;
  EXPECT_THROW(contour_grid({values.data(), {2, 2, 2}}, {{}, {1e308, 1.0, 1.0}}, {}), Error);
  EXPECT_THROW(contour_grid({values.data(), {2, 2, 2}}, {{1e20, 0.0, 0.0}, {1.0, 1.0, 1.0}}, {}),
               Error);
}

}  // namespace
}  // namespace prefilter
