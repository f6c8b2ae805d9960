// SPDX-License-Identifier: GPL-3.0-or-later

// Tests each phase of the treatment of loops crossed by edges.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "prefilter/voxels/contour/blamed_loops.h"
#include "prefilter/voxels/contour/facing.h"
#include "prefilter/voxels/contour/feature_turning.h"
#include "prefilter/voxels/contour/linked_loops.h"
#include "prefilter/voxels/contour/loop_triangles.h"
#include "prefilter/voxels/contour/merged_loops.h"
#include "prefilter/voxels/contour/relaxed_features.h"
#include "prefilter/voxels/contour/sharpen.h"
#include "prefilter/voxels/remesh/intersections.h"
#include "prefilter/voxels/remesh/near_intersections.h"
#include "voxels/contour/mesh_checks.h"

namespace prefilter {
namespace {

using testing::fault_of;
using testing::volume_of;
using Triangle = std::array<std::int32_t, 3>;
using Flags = std::vector<std::uint8_t>;
using Pairs = std::vector<std::array<std::uint32_t, 2>>;

// The planes z = 0 and x = 0, labeled 0 and 1, which intersect in the y axis.
class Wedge final : public FeatureSurface {
 public:
  double cell() const override { return 1.0; }
  std::optional<SourcePoint> nearest(const Vector3& p, double, std::int32_t label) const override {
    if (label == 0) return SourcePoint{{p[0], p[1], 0.0}, {0.0, 0.0, 1.0}, -1, 0};
    return SourcePoint{{0.0, p[1], p[2]}, {1.0, 0.0, 0.0}, -1, 1};
  }
  std::optional<Vector3> nearest_border(const Vector3& p, double, std::int32_t,
                                        std::int32_t) const override {
    return Vector3{0.0, p[1], 0.0};
  }
  std::size_t corner_count() const override { return 0; }
  FeatureCorner corner(std::size_t) const override { return {}; }
};

// Gives each vertex a sample with its own label.
VertexSamples samples_of(const std::vector<Vector3>& positions, bool is_sampled = true) {
  VertexSamples samples;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    samples.index.push_back(is_sampled ? static_cast<std::int32_t>(v) : -1);
    samples.samples.push_back({positions[v], {0.0, 0.0, 1.0}, -1, static_cast<std::int32_t>(v)});
    samples.on_lines.push_back(positions[v]);
    samples.facing.push_back(1.0F);
  }
  return samples;
}

SharpLoop loop_of(const std::vector<std::int32_t>& corners) {
  SharpLoop loop{};
  loop.count = static_cast<int>(corners.size());
  std::copy(corners.begin(), corners.end(), loop.corners.begin());
  return loop;
}

// A cube of side 2 whose sides are sharp loops of four corners, with two triangles each.
struct LoopedCube {
  std::vector<Vector3> positions;
  std::vector<Triangle> plain;
  VertexSamples samples;
  LinkedLoops loops;
  std::vector<Feature> features;

  explicit LoopedCube(double tip) {
    for (int i = 0; i < 8; ++i) {
      positions.push_back({(i & 1) * 2.0 - 1.0, ((i >> 1) & 1) * 2.0 - 1.0, (i >> 2) * 2.0 - 1.0});
    }
    samples = samples_of(positions);
    std::vector<SharpLoop> sides;
    for (const std::vector<std::int32_t>& corners : std::vector<std::vector<std::int32_t>>{
             {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
      SharpLoop loop = loop_of(corners);
      loop.first = plain.size();
      plain.push_back({corners[0], corners[1], corners[2]});
      plain.push_back({corners[0], corners[2], corners[3]});
      loop.end = plain.size();
      sides.push_back(loop);
    }
    for (const double way : {-tip, tip}) features.push_back(feature({0.0, 0.0, way}));
    for (const double way : {-tip, tip}) features.push_back(feature({0.0, way, 0.0}));
    for (const double way : {-tip, tip}) features.push_back(feature({way, 0.0, 0.0}));
    loops = link_loops(sides, Wedge(), samples, prefilter::Run(2));
  }

  static Feature feature(const Vector3& position) { return {position, {}, {0, 1}, false}; }

  FacetedMesh mesh() const { return {positions, {}, {}, Kinds(8, VertexKind::kSurface)}; }
  using Kinds = std::vector<VertexKind>;
};

std::vector<std::size_t> own(std::size_t count) {
  std::vector<std::size_t> merged(count);
  for (std::size_t i = 0; i < count; ++i) merged[i] = i;
  return merged;
}

TEST(LinkedLoops, AreLinkedAcrossTheirSharedSide) {
  const LoopedCube cube(1.0);
  for (std::size_t i = 0; i < 6; ++i) {
    // Brute force: find the loop that contains the side in the opposite direction.
    for (std::size_t k = 0; k < 4; ++k) {
      std::int32_t expected = -1;
      for (std::size_t j = 0; j < 6; ++j) {
        for (std::size_t m = 0; m < 4; ++m) {
          if (cube.loops.loops[j].from(m) == cube.loops.loops[i].to(k) &&
              cube.loops.loops[j].to(m) == cube.loops.loops[i].from(k)) {
            expected = static_cast<std::int32_t>(j);
          }
        }
      }
      EXPECT_TRUE(cube.loops.sides[i][k].is_divided);
      EXPECT_EQ(cube.loops.sides[i][k].other, expected);
    }
  }
  EXPECT_EQ(cube.loops.joined(0, Flags{1, 1, 1, 1, 0, 1}).size(), 3U);
}

TEST(LinkedLoops, AreNotLinkedAcrossTwoSidesOrWithoutAnEdge) {
  std::vector<Vector3> positions(5);
  const std::vector<SharpLoop> twice = {loop_of({0, 1, 2, 3}), loop_of({2, 1, 0, 4})};
  const LinkedLoops loops = link_loops(twice, Wedge(), samples_of(positions), prefilter::Run(1));
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(loops.sides[0][k].other, -1);
  EXPECT_TRUE(loops.sides[0][0].is_divided);
  const std::vector<SharpLoop> pair = {loop_of({0, 1, 2}), loop_of({1, 0, 3})};
  VertexSamples samples = samples_of(positions);
  EXPECT_EQ(link_loops(pair, Wedge(), samples, prefilter::Run(1)).sides[0][0].other, 1);
  samples.index[0] = -1;
  EXPECT_FALSE(link_loops(pair, Wedge(), samples, prefilter::Run(1)).sides[0][0].is_divided);
  // With one label: divided where the normals differ and an edge of the region is near.
  samples = samples_of(positions);
  for (SourcePoint& sample : samples.samples) sample.label = 0;
  EXPECT_FALSE(are_divided(Wedge(), samples, 0, 1));
  samples.samples[1].normal = {1.0, 0.0, 0.0};
  EXPECT_TRUE(are_divided(Wedge(), samples, 0, 1));
}

TEST(MergedLoops, AreWithinATenthOfACell) {
  LoopedCube cube(1.0);
  const auto merged = [&](const Flags& is_sharp, const Flags& is_single) {
    return merged_loops(cube.loops, cube.features, is_sharp, is_single, 2.0);
  };
  const Flags all(6, 1);
  const Flags none(6, 0);
  EXPECT_EQ(merged(all, none), own(6));
  // Loops 0 and 2 are merged, 0 and 1 are not.
  cube.features[2].position = cube.features[0].position + Vector3{0.099, 0.0, 0.0};
  cube.features[1].position = cube.features[0].position;
  EXPECT_EQ(merged(all, none), (std::vector<std::size_t>{0, 0, 0, 3, 4, 5}));  // via loop 2
  EXPECT_EQ(merged(all, {0, 0, 1, 0, 0, 0}), own(6));
  EXPECT_EQ(merged({1, 1, 0, 1, 1, 1}, none), own(6));
  cube.features[2].position = cube.features[0].position + Vector3{0.101, 0.0, 0.0};
  EXPECT_EQ(merged(all, none), own(6));
}

TEST(MergedLoops, ChangeTogether) {
  const std::vector<std::size_t> now = {0, 0, 2, 2, 4};
  Flags changed = {0, 1, 0, 0, 0};
  mark_merged({}, now, &changed);
  EXPECT_EQ(changed, (Flags{1, 1, 0, 0, 0}));
  changed.assign(5, 0);
  mark_merged(std::vector<std::size_t>{0, 0, 2, 3, 4}, now, &changed);
  EXPECT_EQ(changed, (Flags{0, 0, 1, 1, 0}));
}

TEST(LoopTriangles, CloseTheMeshForAnySharpLoops) {
  for (const double tip : {1.0, 2.0}) {
    LoopedCube cube(tip);
    for (unsigned set = 0; set < 64; ++set) {
      Flags is_sharp;
      for (unsigned i = 0; i < 6; ++i) is_sharp.push_back((set >> i) & 1U);
      FacetedMesh mesh = cube.mesh();
      const LoopTriangles made =
          add_loops(cube.loops, cube.plain, cube.features, is_sharp, own(6), cube.samples, &mesh);
      EXPECT_EQ(fault_of({mesh.positions, mesh.triangles}), "") << set;
      const int sharp = std::popcount(set);
      EXPECT_EQ(mesh.triangles.size(), 12U + 2U * static_cast<unsigned>(sharp));  // a sphere
      EXPECT_EQ(made.owners.size(), mesh.triangles.size());
      // Tips at 2 make a rhombic dodecahedron: flipped edges stay in its planes.
      if (tip == 2.0) {
        EXPECT_NEAR(volume_of({mesh.positions, mesh.triangles}), 8.0 + sharp * 4.0 / 3.0, 1e-12);
      }
    }
    FacetedMesh mesh = cube.mesh();
    add_loops(cube.loops, cube.plain, cube.features, Flags(6, 1), own(6), cube.samples, &mesh);
    // Each flip cuts a tetrahedron of volume 1/3 off an edge of the cube.
    if (tip == 1.0) {
      EXPECT_NEAR(volume_of({mesh.positions, mesh.triangles}), 4.0, 1e-12);
    }
    // Each loop has four neighbors, so its vertex is a corner.
    EXPECT_EQ(mesh.kinds[8], VertexKind::kCorner);
  }
}

TEST(LoopTriangles, HaveLoopsAndLabels) {
  const LoopedCube cube(1.0);
  const Flags is_sharp = {1, 0, 1, 1, 0, 0};  // loop 0 is joined to loops 2 and 3
  FacetedMesh mesh = cube.mesh();
  const LoopTriangles made =
      add_loops(cube.loops, cube.plain, cube.features, is_sharp, own(6), cube.samples, &mesh);
  EXPECT_EQ(made.places, (std::vector<std::int32_t>{8, -1, 9, 10, -1, -1}));
  EXPECT_EQ(mesh.kinds[8], VertexKind::kEdge);
  EXPECT_EQ(mesh.kinds[9], VertexKind::kCorner);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [owner, other] = made.owners[t];
    const std::int32_t place = made.places[static_cast<std::size_t>(owner)];
    const auto& triangle = mesh.triangles[t];
    if (place < 0) {
      EXPECT_EQ(mesh.labels[t], triangle[0]);
      continue;
    }
    EXPECT_EQ(triangle[0], place);
    EXPECT_EQ(mesh.labels[t], triangle[1]);  // vertices double as labels
    EXPECT_EQ(other >= 0, triangle[2] >= 8);
  }
}

// The edge is the x axis, between planes at 90 degrees. The part of the middle loop in z = 0 bends
// away from the edge, so that not all of it is visible from the vertex on the edge.
struct BentLoop {
  std::vector<Vector3> positions = {{-0.18, 0.45, 0.0},  {0.04, 1.43, 0.0}, {0.18, 1.38, 0.0},
                                    {-0.135, 0.48, 0.0}, {0.2, 0.0, -0.5},  {-0.4, 0.0, -0.5},
                                    {-1.0, 0.5, 0.0},    {1.0, 0.5, 0.0}};
  VertexSamples samples = samples_of(positions);

  BentLoop() {
    for (std::size_t v = 0; v < positions.size(); ++v) {
      SourcePoint& sample = samples.samples[v];
      const bool is_below = positions[v][2] < 0.0;
      sample.label = is_below ? 1 : 0;
      // The region's own normal is flipped, as for a subtracted shape.
      sample.normal = is_below ? Vector3{0.0, 1.0, 0.0} : Vector3{0.0, 0.0, 1.0};
      samples.facing[v] = -1.0F;
    }
  }

  // A feature on the edge: in the middle, or on the side with most of the loop.
  Feature feature_of(const SharpLoop& loop) const {
    if (loop.count == 6) return LoopedCube::feature({0.0, 0.0, 0.0});
    double sum = 0.0;
    for (int k = 0; k < loop.count; ++k) {
      const std::int32_t corner = loop.from(static_cast<std::size_t>(k));
      sum += positions[static_cast<std::size_t>(corner)][0];
    }
    return LoopedCube::feature({sum < 0.0 ? -0.5 : 0.5, 0.0, 0.0});
  }

  // Triangles of the middle loop in the plane z = 0.
  std::vector<Triangle> triangles(const std::vector<SharpLoop>& sharp) const {
    const LinkedLoops loops = link_loops(sharp, Wedge(), samples, prefilter::Run(1));
    std::vector<Feature> features;
    for (const SharpLoop& loop : sharp) features.push_back(feature_of(loop));
    FacetedMesh mesh = {positions, {}, {}, LoopedCube::Kinds(8, VertexKind::kSurface)};
    const LoopTriangles made =
        add_loops(loops, {}, features, Flags(sharp.size(), 1), own(sharp.size()), samples, &mesh);
    const auto middle = std::find_if(sharp.begin(), sharp.end(),
                                     [](const SharpLoop& loop) { return loop.count == 6; }) -
                        sharp.begin();
    std::vector<Triangle> found;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const bool is_own =
          made.owners[t] == std::array<std::int32_t, 2>{static_cast<std::int32_t>(middle), -1};
      if (is_own && mesh.labels[t] == 0) found.push_back(mesh.triangles[t]);
    }
    return found;
  }

  // Area seen from outside the shape; the vertex of the middle loop is at the origin.
  double area(const Triangle& triangle) const {
    const auto at = [&](std::int32_t v) {
      return v < 8 ? positions[static_cast<std::size_t>(v)] : Vector3{};
    };
    const Vector3 a = at(triangle[0]);
    return -0.5 * cross(at(triangle[1]) - a, at(triangle[2]) - a)[2];
  }
};

TEST(LoopTriangles, BendWithTheirLoop) {
  const BentLoop bent;
  const std::vector<Triangle> found =
      bent.triangles({loop_of({0, 1, 2, 3, 4, 5}), loop_of({5, 6, 0}), loop_of({4, 3, 7})});
  ASSERT_EQ(found.size(), 3U);
  double sum = 0.0;
  for (const Triangle& triangle : found) {
    EXPECT_GT(bent.area(triangle), 0.0);
    sum += bent.area(triangle);
  }
  // The shoelace formula.
  double expected = 0.0;
  const std::vector<Vector3> ring = {
      {}, bent.positions[0], bent.positions[1], bent.positions[2], bent.positions[3]};
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vector3& next = ring[(k + 1) % ring.size()];
    expected -= 0.5 * (ring[k][0] * next[1] - ring[k][1] * next[0]);
  }
  EXPECT_NEAR(sum, expected, 1e-12);
}

// A loop that crosses itself has no triangulation without inverted triangles.
TEST(LoopTriangles, StayAFanIfNoneAreUpright) {
  BentLoop bent;
  std::swap(bent.positions[1], bent.positions[2]);
  const std::vector<Triangle> found =
      bent.triangles({loop_of({0, 1, 2, 3, 4, 5}), loop_of({5, 6, 0}), loop_of({4, 3, 7})});
  ASSERT_EQ(found.size(), 3U);
  bool is_folded = false;
  for (const Triangle& triangle : found) {
    EXPECT_EQ(std::count(triangle.begin(), triangle.end(), 8), 1);
    is_folded = is_folded || bent.area(triangle) < 0.0;
  }
  EXPECT_TRUE(is_folded);
}

TEST(LoopTriangles, GiveEachDiagonalToOneLoop) {
  const BentLoop bent;
  const auto has_diagonal = [&](const std::vector<SharpLoop>& sharp) {
    for (const Triangle& t : bent.triangles(sharp)) {
      if (std::count(t.begin(), t.end(), 0) != 0 && std::count(t.begin(), t.end(), 3) != 0) {
        return true;
      }
    }
    return false;
  };
  const SharpLoop middle = loop_of({0, 1, 2, 3, 4, 5});
  EXPECT_TRUE(has_diagonal({middle, loop_of({5, 6, 0}), loop_of({4, 3, 7})}));
  const LinkedLoops loops =
      link_loops({loop_of({0, 3, 7}), middle}, Wedge(), bent.samples, prefilter::Run(1));
  EXPECT_EQ(loops.sides[1][0].shared, 1U << 3U);
  EXPECT_EQ(loops.sides[1][3].shared, 1U << 0U);
  EXPECT_EQ(loops.sides[0][0].shared, 0U);
  EXPECT_FALSE(has_diagonal({loop_of({5, 6, 0}), loop_of({4, 3, 7}), loop_of({0, 3, 7}), middle}));
}

TEST(LoopTriangles, OfMergedLoopsHaveOneVertex) {
  const LoopedCube cube(1.0);
  const std::vector<std::size_t> merged = {0, 1, 0, 3, 4, 5};
  const Flags is_sharp = {1, 0, 1, 0, 0, 0};
  FacetedMesh mesh = cube.mesh();
  const LoopTriangles made =
      add_loops(cube.loops, cube.plain, cube.features, is_sharp, merged, cube.samples, &mesh);
  EXPECT_EQ(made.places[0], made.places[2]);
  EXPECT_EQ(mesh.positions.size(), 9U);
  EXPECT_EQ(mesh.triangles.size(), 14U);  // count of a sphere
  EXPECT_EQ(fault_of({mesh.positions, mesh.triangles}), "");
}

TEST(MergedLoops, OnOppositeSidesAreSeparated) {
  // Loops 0 and 1 share no side: their vertex would have two fans.
  LoopedCube cube(1.0);
  const std::vector<std::size_t> merged = {0, 0, 2, 3, 4, 5};
  FacetedMesh mesh = cube.mesh();
  const Flags is_sharp = {1, 1, 0, 0, 0, 0};
  const LoopTriangles made =
      add_loops(cube.loops, cube.plain, cube.features, is_sharp, merged, cube.samples, &mesh);
  EXPECT_NE(fault_of({mesh.positions, mesh.triangles}), "");
  Flags flagged(9, 0);
  flagged[8] = 1;
  EXPECT_EQ(pinched_vertices(mesh.triangles, flagged), (std::vector<std::int32_t>{8}));
  EXPECT_TRUE(repeating_triangles(mesh.triangles, flagged).empty());
  Flags is_single(6, 0);
  Flags is_changed(6, 0);
  EXPECT_TRUE(unmerge(mesh.triangles, made, merged, &is_single, &is_changed));
  EXPECT_EQ(is_single, (Flags{1, 1, 0, 0, 0, 0}));
  EXPECT_EQ(is_changed, is_single);
  EXPECT_FALSE(unmerge(mesh.triangles, made, merged, &is_single, &is_changed));
}

TEST(MergedLoops, WithRepeatedSidesAreSeparated) {
  // One vertex for three loops around a corner, another for the three others: each side between
  // them occurs three times.
  LoopedCube cube(1.0);
  const std::vector<std::size_t> merged = {0, 1, 0, 1, 0, 1};
  FacetedMesh mesh = cube.mesh();
  const LoopTriangles made =
      add_loops(cube.loops, cube.plain, cube.features, Flags(6, 1), merged, cube.samples, &mesh);
  std::map<std::pair<std::int32_t, std::int32_t>, int> counts;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++counts[{t[k], t[(k + 1) % 3]}];
  }
  std::set<std::size_t> expected;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (counts[{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}] > 1) expected.insert(t);
    }
  }
  ASSERT_FALSE(expected.empty());
  Flags flagged(mesh.positions.size(), 0);
  flagged[8] = flagged[9] = 1;
  const std::vector<std::size_t> found = repeating_triangles(mesh.triangles, flagged);
  EXPECT_EQ(std::set<std::size_t>(found.begin(), found.end()), expected);
  Flags is_single(6, 0);
  Flags is_changed(6, 0);
  EXPECT_TRUE(unmerge(mesh.triangles, made, merged, &is_single, &is_changed));
  EXPECT_EQ(is_single, Flags(6, 1));
}

TEST(FewestLoops, AreChosenByTheirPairs) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    const std::size_t pairs = 1 + random() % 12;
    std::set<std::pair<std::int32_t, std::size_t>> blamed;
    for (std::size_t i = random() % 30; i-- > 0;) {
      blamed.insert({static_cast<std::int32_t>(random() % 8), random() % pairs});
    }
    // Recount for each loop.
    std::set<std::size_t> open;
    for (const auto& [loop, pair] : blamed) open.insert(pair);
    std::vector<std::size_t> expected;
    while (!open.empty()) {
      std::array<int, 8> counts{};
      for (const auto& [loop, pair] : blamed) {
        if (open.contains(pair)) ++counts[static_cast<std::size_t>(loop)];
      }
      const auto best =
          static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
      expected.push_back(best);
      for (const auto& [loop, pair] : blamed) {
        if (static_cast<std::size_t>(loop) == best) open.erase(pair);
      }
    }
    std::vector<BlamedLoop> given;
    for (const auto& [loop, pair] : blamed) given.push_back({loop, pair});
    std::shuffle(given.begin(), given.end(), random);
    EXPECT_EQ(fewest_loops(given, pairs), expected);
  }
}

TEST(NearIntersections, EqualTheIntersectionsOfSuspects) {
  std::mt19937 random(11);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  TriangleMesh mesh;
  for (std::int32_t t = 0; t < 400; ++t) {
    const Vector3 at = {20.0 * uniform() - 10.0, 20.0 * uniform() - 10.0, 6.0 * uniform() - 3.0};
    for (int i = 0; i < 3; ++i) {
      const double size = t % 10 == 0 ? 7.0 : 2.0;
      mesh.positions.push_back(at + Vector3{size * uniform(), size * uniform(), size * uniform()});
    }
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  constexpr std::size_t kFirst = 50;
  Flags is_suspect(mesh.triangles.size(), 0);
  for (std::size_t t = kFirst; t < is_suspect.size(); ++t) is_suspect[t] = t % 9 == 0 ? 1 : 0;
  Pairs expected;
  for (const auto& pair :
       intersecting_triangles({mesh.positions, mesh.triangles}, {}, prefilter::Run(1))) {
    if (std::min(pair[0], pair[1]) < kFirst) continue;
    if (is_suspect[pair[0]] != 0 || is_suspect[pair[1]] != 0) expected.push_back(pair);
  }
  ASSERT_GT(expected.size(), 10U);
  const MeshView<std::int32_t> view{mesh.positions, mesh.triangles};
  for (const double side : {0.5, 2.0, 100.0}) {
    EXPECT_EQ(near_intersections(view, kFirst, is_suspect, side, prefilter::Run(2)), expected);
  }
  const Flags none(mesh.triangles.size(), 0);
  EXPECT_TRUE(near_intersections(view, 0, none, 1.0, prefilter::Run(1)).empty());
}

TEST(Facing, FollowsTheSamples) {
  const std::vector<Vector3> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  VertexSamples samples = samples_of(positions);
  for (SourcePoint& sample : samples.samples) sample.label = 7;
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 1}, {0, 1, 3}, {0, 0, 1}};
  const MeshView<std::int32_t> view{positions, triangles};
  const auto is_down = [&](std::size_t t, std::int32_t label,
                           const std::unordered_set<std::int32_t>& turned) {
    return is_upside_down(view, t, label, samples, turned, 1.0);
  };
  EXPECT_FALSE(is_down(0, 7, {}));
  EXPECT_TRUE(is_down(1, 7, {}));
  EXPECT_TRUE(is_down(2, 7, {}));   // 90 degrees to the normals: cosine below 0.05
  EXPECT_TRUE(is_down(3, 7, {}));   // no area
  EXPECT_FALSE(is_down(1, 8, {}));  // corners of another label
  EXPECT_TRUE(is_down(0, 7, {7}));
  EXPECT_FALSE(is_down(1, 7, {7}));
  samples.samples[2].normal = {0.0, 0.0, -1.0};  // one corner that agrees is enough
  EXPECT_FALSE(is_down(1, 7, {}));
  EXPECT_TRUE(turned_labels(samples).empty());
  samples.facing = {-1.0F, -0.5F, 0.25F, 0.5F};
  EXPECT_EQ(turned_labels(samples).count(7), 1U);
}

// Loops in a row along the y axis, each next to the following one, on two planes that intersect
// there.
struct Row {
  std::vector<Vector3> positions;
  VertexSamples samples;
  LinkedLoops loops;

  explicit Row(std::size_t count) {
    std::vector<SharpLoop> corners;
    for (std::size_t i = 0; i <= count; ++i) {
      positions.push_back({-0.5, static_cast<double>(i) - 0.5, 0.0});
      positions.push_back({0.0, static_cast<double>(i) - 0.5, -0.5});
    }
    samples = samples_of(positions);
    for (std::size_t i = 0; i < count; ++i) {
      const auto v = static_cast<std::int32_t>(2 * i);
      corners.push_back(loop_of({v, v + 2, v + 3, v + 1}));
    }
    for (std::size_t v = 0; v < positions.size(); ++v) {
      samples.samples[v].label = static_cast<std::int32_t>(v % 2);
      samples.samples[v].normal = v % 2 == 0 ? Vector3{0.0, 0.0, -1.0} : Vector3{-1.0, 0.0, 0.0};
    }
    loops = link_loops(corners, Wedge(), samples, prefilter::Run(1));
  }
};

std::vector<Feature> features_at(std::initializer_list<double> ys) {
  std::vector<Feature> features;
  for (const double y : ys) features.push_back({{0.0, y, 0.0}, {-1.0, y, -1.0}, {0, 1}, false});
  return features;
}

TEST(RelaxedFeatures, AreBackInOrder) {
  const Row row(9);
  const LinkedLoops& loops = row.loops;
  const Wedge wedge;
  const FeaturePlaces places(wedge);
  const std::vector<Feature> before = features_at({0.0, 1.0, 2.0, 4.2, 4.0, 3.8, 6.0, 7.0, 8.0});
  std::vector<Feature> features = before;
  const Flags all(9, 1);
  const std::unordered_set<std::int32_t> none;
  const FeatureTurning turning(loops, all, row.positions, row.samples, none, places, 1.0);
  EXPECT_EQ(relax_features({4}, loops, all, places, turning, &features),
            (std::vector<std::size_t>{2, 3, 4, 5, 6}));
  for (std::size_t i = 1; i < 9; ++i) {
    EXPECT_LT(features[i - 1].position[1], features[i].position[1]) << i;
    EXPECT_EQ(features[i].position[0], 0.0);
  }
  for (const std::size_t i : {0, 1, 7, 8}) EXPECT_EQ(features[i].position, before[i].position);
  // Corners stay, and so do features with one neighbor.
  features = before;
  features[3].is_corner = true;
  relax_features({4}, loops, all, places, turning, &features);
  EXPECT_EQ(features[3].position, before[3].position);
  features = before;
  EXPECT_EQ(relax_features({0}, loops, all, places, turning, &features),
            (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(features[0].position, before[0].position);
  EXPECT_TRUE(relax_features({}, loops, all, places, turning, &features).empty());
}

// Seen from above, the side from (-0.5, 3.5) to (-0.3, 3.6) faces the y axis only below 3.75.
TEST(FeatureTurning, PutsTrianglesUpright) {
  Row row(9);
  row.positions[10] = {-0.3, 3.6, 0.0};
  const Wedge wedge;
  const FeaturePlaces places(wedge);
  const Flags all(9, 1);
  const std::vector<Feature> before = features_at({0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0});
  const std::unordered_set<std::int32_t> none;
  const FeatureTurning turning(row.loops, all, row.positions, row.samples, none, places, 1.0);
  const std::optional<Vector3> found = turning.place(4, before);
  ASSERT_TRUE(found);
  EXPECT_NEAR((*found)[1], 3.75 - 0.05 * std::sqrt(5.0) / 2.0, 1e-6);
  EXPECT_EQ((*found)[0], 0.0);
  for (const std::size_t i : {0, 1, 3, 5, 8}) EXPECT_FALSE(turning.place(i, before)) << i;
  std::vector<Feature> features = before;
  features[4].is_corner = true;
  EXPECT_FALSE(turning.place(4, features));
  features = before;
  features[4].start = {-0.5, 4.0, -0.5};  // close to the edge
  EXPECT_FALSE(turning.place(4, features));
  features = before;
  relax_features({4}, row.loops, all, places, turning, &features);
  EXPECT_NEAR(features[4].position[1], (*found)[1], 1e-6);
  // Seen from below, all others are inverted, and stay so.
  for (SourcePoint& sample : row.samples.samples) sample.normal = -1.0 * sample.normal;
  EXPECT_FALSE(turning.place(4, before));
  const std::unordered_set<std::int32_t> both = {0, 1};
  const FeatureTurning turned(row.loops, all, row.positions, row.samples, both, places, 1.0);
  EXPECT_TRUE(turned.place(4, before));
}

}  // namespace
}  // namespace prefilter
