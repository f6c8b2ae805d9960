// SPDX-License-Identifier: GPL-3.0-or-later

// Samples of spheres in slabs, for tests of the reconstruction.
#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/points/array_source.h"
#include "prefilter/points/reconstruct/gather_samples.h"
#include "prefilter/points/reconstruct/sample_grid.h"
#include "prefilter/points/reconstruct/sample_store.h"

namespace prefilter::testing {

/// Points in the unit cube, with normals.
struct TestCloud {
  std::vector<Vector3> points;
  std::vector<Vector3> normals;

  ArraySource source() const { return {points, normals, {}, {}, {}}; }
};

/// Random points of a sphere around the center of the unit cube.
inline TestCloud sphere_cloud(int count, double radius = 0.35) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  TestCloud cloud;
  for (int i = 0; i < count; ++i) {
    Vector3 n = {normal(random), normal(random), normal(random)};
    const double size = length(n);
    for (double& x : n) x /= size;
    cloud.points.push_back({0.5 + radius * n[0], 0.5 + radius * n[1], 0.5 + radius * n[2]});
    cloud.normals.push_back(n);
  }
  return cloud;
}

/// A dense lower half and a sparse upper one, so that leaves have several depths, some above the
/// slabs' depth.
inline TestCloud uneven_sphere_cloud() {
  const TestCloud all = sphere_cloud(20000);
  TestCloud cloud;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    if (all.points[i][2] > 0.5 && i % 16 != 0) continue;
    cloud.points.push_back(all.points[i]);
    cloud.normals.push_back(all.normals[i]);
  }
  return cloud;
}

/// A dense sphere and six points far from all others.
inline TestCloud stray_cloud() {
  TestCloud cloud = sphere_cloud(20000);
  for (const double x : {0.05, 0.5, 0.95}) {
    for (const double z : {0.02, 0.98}) {
      cloud.points.push_back({x, 0.05, z});
      cloud.normals.push_back({0.0, 0.0, 1.0});
    }
  }
  return cloud;
}

/// The grid over the unit cube.
inline SampleGrid unit_grid(int depth) {
  SampleGrid grid;
  grid.depth = depth;
  grid.cell = std::ldexp(1.0, -depth);
  return grid;
}

/// The cloud's samples in cells of unit_grid(), in slabs of 2^slab_bits cells.
class CloudStore : public SampleStore {
 public:
  CloudStore(const TestCloud& cloud, int depth, int slab_bits)
      : SampleStore(depth, slab_bits, 0, std::numeric_limits<std::uint64_t>::max(), "") {
    ArraySource source = cloud.source();
    gather_samples(&source, unit_grid(depth), prefilter::Run(1), this);
  }
};

}  // namespace prefilter::testing
