// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/quad_contour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/voxels/contour/marching_table.h"
#include "wavelet/random_tree.h"

namespace prefilter {
namespace {

constexpr Box kUnit = {{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};

// Returns an empty string for a closed two-manifold without unused vertices.
std::string fault_of(const QuadMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> after;
  std::vector<int> counts(mesh.positions.size());
  for (const auto& quad : mesh.quads) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (quad[k] < 0) return "a quad lacks a corner";
      ++counts[static_cast<std::size_t>(quad[k])];
      if (!after.insert({{quad[k], quad[(k + 1) % 4]}, quad[(k + 3) % 4]}).second) {
        return "an edge is there twice in one direction";
      }
    }
  }
  std::map<std::int32_t, std::int32_t> starts;
  for (const auto& [edge, before] : after) {
    if (!after.contains({edge.second, edge.first})) return "an edge is open";
    starts.insert({edge.first, edge.second});
  }
  for (std::size_t v = 0; v < counts.size(); ++v) {
    const auto vertex = static_cast<std::int32_t>(v);
    if (counts[v] == 0) return "a vertex has no quad";
    int count = 0;
    std::int32_t at = starts.at(vertex);
    do {
      at = after.at({vertex, at});
      ++count;
    } while (at != starts.at(vertex) && count <= counts[v]);
    if (count != counts[v]) return "the quads around a vertex are not one fan";
  }
  return "";
}

// A tree with leaves at one depth, each full or empty at random.
CellTree uniform_tree(unsigned seed, int depth) {
  std::mt19937 random(seed);
  CellTree tree;
  std::size_t blocks = 1;
  for (int k = 0; k < depth; ++k) {
    TreeLevel level;
    level.blocks.resize(blocks);
    for (OctantValues& block : level.blocks) {
      for (float& value : block) value = random() % 2 == 0 ? 0.0F : 1.0F;
      level.split.push_back(k + 1 < depth ? 255 : 0);
    }
    blocks *= 8;
    link_blocks(&level);
    tree.levels.push_back(std::move(level));
  }
  update_means(&tree, prefilter::Run(1));
  return tree;
}

TEST(QuadContour, IsManifoldForAnyCells) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    for (const Interpolant interpolant : {Interpolant::kOccupancy, Interpolant::kPlane,
                                          Interpolant::kLinear, Interpolant::kSharp}) {
      if (interpolant != Interpolant::kOccupancy && seed > 3) continue;
      ContourOptions options;
      options.interpolant = interpolant;
      options.run = prefilter::Run(1);
      ASSERT_EQ(fault_of(contour_quads(uniform_tree(seed, 3), kUnit, options)), "") << seed;
    }
  }
}

TEST(QuadContour, IsManifoldForAnyTree) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    for (const Interpolant interpolant : {Interpolant::kPlane, Interpolant::kOccupancy}) {
      ContourOptions options;
      options.interpolant = interpolant;
      options.run = prefilter::Run(1);
      ASSERT_EQ(fault_of(contour_quads(random_tree(seed, 4), kUnit, options)), "") << seed;
    }
  }
}

TEST(QuadContour, IsACubeForOneCell) {
  CellTree tree;
  tree.root = 1.0F;
  ContourOptions options;
  options.interpolant = Interpolant::kOccupancy;
  const QuadMesh mesh = contour_quads(tree, kUnit, options);
  EXPECT_EQ(fault_of(mesh), "");
  EXPECT_EQ(mesh.positions.size(), mesh.quads.size() + 2);
}

TEST(QuadContour, RefusesOtherIsovalues) {
  ContourOptions options;
  options.isovalue = 0.4F;
  EXPECT_THROW(contour_quads(uniform_tree(1, 2), kUnit, options), Error);
}

// Guarantees that one face can be cut the other way without looking at the others.
TEST(MarchingCases, OnlyCasesOfOneAmbiguousFaceHaveALoopThatPassesItTwice) {
  std::set<unsigned> found;
  for (unsigned inside = 0; inside < 256; ++inside) {
    const MarchingCase& one = marching_cases()[inside];
    for (const MarchingLoop& loop : one.loops) {
      std::map<unsigned, int> passes;
      for (std::size_t k = 0; k < loop.size(); ++k) {
        ++passes[faces_of_edge(loop[k]) & faces_of_edge(loop[(k + 1) % loop.size()])];
      }
      for (const auto& [face, count] : passes) {
        if (count < 2) continue;
        found.insert(inside);
        EXPECT_EQ(one.ambiguous_faces, face) << inside;
        EXPECT_EQ(marching_loops(inside, face).size(), one.loops.size() + 1);
      }
    }
  }
  EXPECT_EQ(found.size(), 36);
}

}  // namespace
}  // namespace prefilter
