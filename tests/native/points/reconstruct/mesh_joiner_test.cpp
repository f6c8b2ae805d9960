// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/mesh_joiner.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "prefilter/points/array_sink.h"
#include "prefilter/voxels/tree_contour.h"
#include "voxels/contour/mesh_checks.h"
#include "wavelet/random_tree.h"

namespace prefilter {
namespace {

constexpr int kDepth = 5;
constexpr int kSide = 1 << kDepth;
constexpr Box kUnitCube = {{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};

// The corners of a triangle, rotated so that the smallest comes first.
using Corners = std::array<Vector3, 3>;

std::vector<Corners> sorted_corners(const std::vector<Vector3>& positions,
                                    const std::vector<std::array<std::int32_t, 3>>& triangles) {
  std::vector<Corners> result;
  for (const auto& triangle : triangles) {
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = positions[static_cast<std::size_t>(triangle[i])];
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    result.push_back(corners);
  }
  std::sort(result.begin(), result.end());
  return result;
}

struct Joined {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<float> attributes;
};

// The surface joined from slabs of this height, without vertices for which is_trimmed is true.
template <typename IsTrimmed>
Joined join_slabs(const CellTree& tree, Interpolant interpolant, int height,
                  const IsTrimmed& is_trimmed) {
  SampleGrid grid;
  grid.depth = kDepth;
  grid.cell = 1.0 / kSide;
  ArraySink sink;
  MeshJoiner joiner(grid, 1, &sink);
  for (int low = 0; low < kSide; low += height) {
    const int top = low + height < kSide ? low + height : kSide + 1;
    SlabMesh slab;
    slab.contour = contour_slab(tree, 0.5F, interpolant, {low, top});
    for (Vector3& p : slab.contour.mesh.positions) {
      slab.is_trimmed.push_back(is_trimmed(p) ? 1 : 0);
      slab.attributes.push_back(static_cast<float>(p[0] + 2.0 * p[1]));
      for (double& x : p) x *= kSide;
    }
    joiner.add(slab, top);
  }
  Joined joined = {sink.take_positions(), sink.take_triangles(), sink.take_attributes()};
  EXPECT_EQ(joiner.vertices(), joined.positions.size());
  EXPECT_EQ(joiner.triangles(), joined.triangles.size());
  return joined;
}

TEST(MeshJoiner, JoinedSlabsEqualTheWholeMesh) {
  for (const Interpolant interpolant : {Interpolant::kLinear, Interpolant::kOccupancy}) {
    for (unsigned seed = 0; seed < 4; ++seed) {
      const CellTree tree = random_tree(seed, kDepth);
      ASSERT_EQ(tree.depth(), kDepth);
      ContourOptions options;
      options.interpolant = interpolant;
      options.clean_up = false;
      options.run = prefilter::Run(1);
      const TriangleMesh whole = contour_slab(tree, 0.5F, interpolant, {0, kSide + 1}).mesh;
      EXPECT_EQ(whole.triangles.size(), contour_tree(tree, kUnitCube, options).triangles.size());
      for (const int height : {1, 4, kSide / 2, kSide}) {
        const Joined joined =
            join_slabs(tree, interpolant, height, [](const Vector3&) { return false; });
        EXPECT_EQ(joined.positions.size(), whole.positions.size());
        ASSERT_EQ(sorted_corners(joined.positions, joined.triangles),
                  sorted_corners(whole.positions, whole.triangles));
        EXPECT_EQ(testing::fault_of({joined.positions, joined.triangles}), "");
        for (std::size_t v = 0; v < joined.positions.size(); ++v) {
          const Vector3& p = joined.positions[v];
          ASSERT_EQ(joined.attributes[v], static_cast<float>(p[0] + 2.0 * p[1]));
        }
      }
    }
  }
}

TEST(MeshJoiner, OmitsTrianglesOfTrimmedVertices) {
  const CellTree tree = random_tree(3, kDepth);
  const TriangleMesh whole = contour_slab(tree, 0.5F, Interpolant::kLinear, {0, kSide + 1}).mesh;
  const auto is_trimmed = [](const Vector3& p) { return p[0] + p[2] > 0.7; };
  std::vector<std::array<std::int32_t, 3>> kept;
  for (const auto& t : whole.triangles) {
    const bool is_kept = std::none_of(t.begin(), t.end(), [&](std::int32_t v) {
      return is_trimmed(whole.positions[static_cast<std::size_t>(v)]);
    });
    if (is_kept) kept.push_back(t);
  }
  ASSERT_FALSE(kept.empty());
  ASSERT_LT(kept.size(), whole.triangles.size());
  const Joined joined = join_slabs(tree, Interpolant::kLinear, 8, is_trimmed);
  EXPECT_EQ(sorted_corners(joined.positions, joined.triangles),
            sorted_corners(whole.positions, kept));
  // Every vertex belongs to a triangle.
  std::vector<bool> is_used(joined.positions.size());
  for (const auto& t : joined.triangles) {
    for (const std::int32_t v : t) is_used[static_cast<std::size_t>(v)] = true;
  }
  EXPECT_EQ(std::count(is_used.begin(), is_used.end(), false), 0);
}

}  // namespace
}  // namespace prefilter
