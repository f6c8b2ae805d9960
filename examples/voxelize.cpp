// SPDX-License-Identifier: GPL-3.0-or-later

// Two meshes voxelized, united, and the surface of both written to a PLY file.
//
// usage: voxelize OUT.ply
#include "prefilter/voxels/voxelize.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/points/ply_mesh_writer.h"
#include "prefilter/voxels/combine.h"
#include "prefilter/voxels/queries.h"
#include "prefilter/voxels/tree_contour.h"

namespace {

/// A box from one corner to another.
prefilter::TriangleMesh box(const prefilter::Vector3& low, const prefilter::Vector3& high) {
  prefilter::TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.push_back({(corner & 1) != 0 ? high[0] : low[0],
                              (corner & 2) != 0 ? high[1] : low[1],
                              (corner & 4) != 0 ? high[2] : low[2]});
  }
  // Counter-clockwise as seen from outside.
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: voxelize OUT.ply\n");
    return 2;
  }
  try {
    const prefilter::TriangleMesh first = box({0.0, 0.0, 0.0}, {1.0, 1.0, 1.0});
    const prefilter::TriangleMesh second = box({0.5, 0.5, 0.5}, {1.3, 1.3, 1.3});

    prefilter::VoxelizeOptions options;
    options.depth = 6;  // 64 cells along an axis
    options.bounds = prefilter::Box{{-0.25, -0.25, -0.25}, {1.75, 1.75, 1.75}};
    const prefilter::Octree a = prefilter::voxelize({first.positions, first.triangles}, options);
    const prefilter::Octree b = prefilter::voxelize({second.positions, second.triangles}, options);
    const prefilter::Octree both =
        prefilter::combine(a, b, prefilter::SetOperation::kUnion, options.run);
    std::printf("volume: %.6f\n", prefilter::volume(both));

    prefilter::ContourOptions contour;
    contour.adaptivity = 0.01;  // larger triangles, no farther off than a hundredth of a cell
    const prefilter::TriangleMesh mesh =
        prefilter::contour_occupancies(both.cells, both.bounds, contour);

    prefilter::PlyMeshWriter file(argv[1], {}, true);
    file.add_vertices(mesh.positions, {});
    std::vector<std::array<std::int64_t, 3>> triangles;
    for (const auto& [a, b, c] : mesh.triangles) triangles.push_back({a, b, c});
    file.add_triangles(triangles);
    file.finish(prefilter::Run());
    std::printf("triangles: %zu\n", mesh.triangles.size());
  } catch (const prefilter::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
