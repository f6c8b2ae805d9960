// SPDX-License-Identifier: GPL-3.0-or-later

// The surface of a file of points with normals, of any size: neither the points nor the mesh have
// to fit into memory.
//
// usage: reconstruct IN OUT.ply
#include "prefilter/points/reconstruct.h"

#include <cstdio>
#include <memory>

#include "prefilter/base/error.h"
#include "prefilter/points/open_points.h"
#include "prefilter/points/ply_mesh_writer.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: reconstruct IN OUT.ply\n");
    return 2;
  }
  try {
    const std::unique_ptr<prefilter::PointSource> points = prefilter::open_points(argv[1]);
    prefilter::PlyMeshWriter file(argv[2], points->attributes(), points->is_double());

    prefilter::ReconstructOptions options;
    options.depth = 6;  // 64 cells along the longest axis
    options.run = prefilter::Run([](double done) {
      std::fprintf(stderr, "\r%3.0f %%", 100.0 * done);
      return true;  // go on
    });
    const prefilter::ReconstructReport report =
        prefilter::reconstruct(points.get(), options, &file);
    file.finish(prefilter::Run());
    std::printf("points: %zu\nvertices: %zu\ntriangles: %zu\n", report.points, report.vertices,
                report.triangles);
  } catch (const prefilter::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
