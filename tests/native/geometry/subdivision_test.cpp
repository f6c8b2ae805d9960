// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/subdivision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

struct Mesh {
  std::vector<double> positions;
  std::vector<std::int64_t> face_sizes;
  std::vector<std::int64_t> face_vertices;
  std::vector<double> face_uvs;

  // Different texture coordinates for every corner of the mesh, or one per vertex.
  void add_uvs(bool seams) {
    for (std::size_t i = 0; i < face_vertices.size(); ++i) {
      const double value = seams ? static_cast<double>(i) : static_cast<double>(face_vertices[i]);
      face_uvs.insert(face_uvs.end(), {std::cos(value), std::sin(1.7 * value)});
    }
  }

  PolygonArrays arrays() const {
    PolygonArrays mesh;
    mesh.positions = positions.data();
    mesh.vertex_count = positions.size() / 3;
    mesh.face_sizes = face_sizes.data();
    mesh.face_count = face_sizes.size();
    mesh.face_vertices = face_vertices.data();
    mesh.face_uvs = face_uvs.data();
    mesh.corner_count = face_vertices.size();
    return mesh;
  }
};

Mesh cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    for (int axis = 0; axis < 3; ++axis) mesh.positions.push_back((i >> axis & 1) * 2 - 1);
  }
  mesh.face_sizes.assign(6, 4);
  mesh.face_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
  return mesh;
}

TEST(Subdivide, CornersOfACubeGoHalfWay) {
  Mesh mesh = cube();
  mesh.add_uvs(false);
  const Surface surface = subdivide(mesh.arrays(), {});
  EXPECT_EQ(surface.triangle_count(), 768u);
  EXPECT_EQ(surface.positions.size(), 386u);
  for (std::size_t corner = 0; corner < 8; ++corner) {
    double nearest = 1.0;
    for (const auto& p : surface.positions) {
      double distance = 0.0;
      for (int k = 0; k < 3; ++k) {
        distance = std::max(distance, std::abs(p[k] - mesh.positions[3 * corner + k] / 2.0));
      }
      nearest = std::min(nearest, distance);
    }
    EXPECT_LT(nearest, 1e-14);
  }
}

// Random polygon soups: edges of many faces, faces that share vertices only, any orientation.
TEST(Subdivide, AcceptsRandomPolygons) {
  for (unsigned seed = 0; seed < 150; ++seed) {
    std::mt19937 random(seed);
    Mesh mesh;
    const int vertices = 5 + static_cast<int>(seed % 11);
    for (int i = 0; i < 3 * vertices; ++i) {
      mesh.positions.push_back(std::uniform_real_distribution<double>(-1.0, 1.0)(random));
    }
    std::vector<std::int64_t> all(vertices);
    for (int i = 0; i < vertices; ++i) all[i] = i;
    for (int face = 0; face < 1 + static_cast<int>(seed % 13); ++face) {
      std::shuffle(all.begin(), all.end(), random);
      const int size = 3 + static_cast<int>(random() % 3);
      mesh.face_sizes.push_back(size);
      mesh.face_vertices.insert(mesh.face_vertices.end(), all.begin(), all.begin() + size);
    }
    mesh.add_uvs(seed % 2 == 0);
    for (int rule = 0; rule < 6; ++rule) {
      SubdivisionOptions options;
      options.level = 2;
      options.uv_interpolation = static_cast<UvInterpolation>(rule);
      options.boundary =
          seed % 3 == 0 ? SubdivisionBoundary::kEdgeOnly : SubdivisionBoundary::kEdgeAndCorner;
      const Surface surface = subdivide(mesh.arrays(), options);
      EXPECT_EQ(surface.triangle_count(), 8 * mesh.face_vertices.size());
      EXPECT_GT(surface.total_area(), 0.0);
      double extent = 0.0;
      for (const auto& uvs : surface.uvs) {
        for (const TextureCoordinate& uv : uvs) {
          extent = std::max({extent, std::abs(uv.u), std::abs(uv.v)});
        }
      }
      EXPECT_LT(extent, 2.0) << "seed " << seed << " rule " << rule;
    }
  }
}

TEST(Subdivide, StopsWhenAskedTo) {
  Mesh mesh = cube();
  mesh.add_uvs(true);
  SubdivisionOptions options;
  options.run = prefilter::Run([](double) { return false; });
  EXPECT_THROW(subdivide(mesh.arrays(), options), Error);
}

}  // namespace
}  // namespace prefilter
