// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/spread_labels.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

namespace prefilter {
namespace {

using Corners = std::vector<std::array<std::int32_t, 3>>;

FacetedMesh mesh_of(std::size_t vertices, const Corners& triangles) {
  FacetedMesh mesh;
  mesh.positions.resize(vertices);
  mesh.triangles = triangles;
  return mesh;
}

// A strip of triangles, each adjacent to the next; vertices are numbered along it.
FacetedMesh strip(std::int32_t count, std::int32_t first = 0) {
  Corners triangles;
  for (std::int32_t t = first; t < first + count; ++t) {
    if (t % 2 == 0) triangles.push_back({t, t + 1, t + 2});
    if (t % 2 == 1) triangles.push_back({t + 1, t, t + 2});
  }
  return mesh_of(static_cast<std::size_t>(first + count + 2), triangles);
}

TEST(SpreadLabels, TheNearerLabelWins) {
  FacetedMesh mesh = strip(7);
  mesh.labels = {5, kNoLabel, kNoLabel, kNoLabel, kNoLabel, kNoLabel, 2};
  EXPECT_EQ(spread_labels(&mesh, 6, prefilter::Run()), 0);
  EXPECT_EQ(mesh.labels, (std::vector<std::int32_t>{5, 5, 5, 5, 2, 2, 2}));
}

TEST(SpreadLabels, PartsWithoutAnyGetNewOnes) {
  FacetedMesh mesh = strip(3);
  const FacetedMesh other = strip(2, 6);
  mesh.positions.resize(other.positions.size());
  mesh.triangles.insert(mesh.triangles.end(), other.triangles.begin(), other.triangles.end());
  mesh.labels = {kNoLabel, 1, kNoLabel};
  EXPECT_EQ(spread_labels(&mesh, 4, prefilter::Run()), 1);
  EXPECT_EQ(mesh.labels, (std::vector<std::int32_t>{1, 1, 1, 4, 4}));
}

// Where four triangles share an edge, each is paired with one other, in the order of the list.
TEST(SpreadLabels, PairsTrianglesAtAnEdge) {
  FacetedMesh mesh = mesh_of(6, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {1, 0, 5}});
  mesh.labels = {kNoLabel, 7, 3, kNoLabel};
  EXPECT_EQ(spread_labels(&mesh, 8, prefilter::Run()), 0);
  EXPECT_EQ(mesh.labels, (std::vector<std::int32_t>{7, 7, 3, 3}));
}

TEST(SpreadLabels, OneVertexIsNotEnough) {
  FacetedMesh mesh = mesh_of(5, {{0, 1, 2}, {0, 3, 4}});
  mesh.labels = {0, kNoLabel};
  EXPECT_EQ(spread_labels(&mesh, 1, prefilter::Run()), 1);
  EXPECT_EQ(mesh.labels, (std::vector<std::int32_t>{0, 1}));
}

}  // namespace
}  // namespace prefilter
