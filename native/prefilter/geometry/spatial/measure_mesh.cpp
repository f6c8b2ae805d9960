// SPDX-License-Identifier: GPL-3.0-or-later

// The volume is the sum of the signed volumes of tetrahedra.
#include "prefilter/geometry/measure_mesh.h"

#include <vector>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

constexpr std::int64_t kTrianglesPerTask = 1 << 14;

MeshMeasures measure_some(const InputMesh& mesh, std::int64_t begin, std::int64_t end,
                          const Vector3& origin) {
  MeshMeasures some;
  double areas = 0.0;
  double volumes = 0.0;
  for (std::int64_t t = begin; t < end; ++t) {
    const auto [a, b, c] = mesh.corners(static_cast<std::size_t>(t));
    some.box.include(a);
    some.box.include(b);
    some.box.include(c);
    const Vector3 twice_area = cross(b - a, c - a);
    areas += length(twice_area);
    volumes += dot(a - origin, twice_area);
  }
  some.area = areas / 2.0;
  some.volume = volumes / 6.0;
  return some;
}

}  // namespace

MeshMeasures measure_mesh(const InputMesh& mesh, const Run& run) {
  check_mesh(mesh, kLargestCoordinate);
  const auto count = static_cast<std::int64_t>(mesh.triangles.size());
  const Vector3 origin = mesh.corners(0)[0];
  std::vector<MeshMeasures> parts(static_cast<std::size_t>(range_count(count, kTrianglesPerTask)));
  parallel_ranges(count, kTrianglesPerTask, run, [&](std::int64_t begin, std::int64_t end) {
    parts[static_cast<std::size_t>(begin / kTrianglesPerTask)] =
        measure_some(mesh, begin, end, origin);
  });
  MeshMeasures all;
  for (const MeshMeasures& part : parts) {
    all.box.include(part.box);
    all.area += part.area;
    all.volume += part.volume;
  }
  return all;
}

}  // namespace prefilter
