// SPDX-License-Identifier: GPL-3.0-or-later

// Counts the pairs of triangles that cut each other, with exact predicates of CGAL.
//
// Usage: self_intersections MESH...
// A mesh is two int64, the numbers of vertices and triangles, then float64 positions and int64
// triangles. For each prints the number of pairs, of triangles in them, of triangles without area,
// and the triangles of the first pair (-1 where there is none).

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::size_t>;
using Triangle = std::array<std::int64_t, 3>;

struct Mesh {
  std::vector<Point> points;
  std::vector<Triangle> triangles;

  const Point& corner(const Triangle& triangle, int k) const {
    return points[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
  }
  Kernel::Triangle_3 shape(const Triangle& t) const {
    return {corner(t, 0), corner(t, 1), corner(t, 2)};
  }
};

Mesh read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  std::array<std::int64_t, 2> counts{};
  file.read(reinterpret_cast<char*>(counts.data()), sizeof(counts));
  std::vector<double> positions(static_cast<std::size_t>(3 * counts[0]));
  Mesh mesh;
  mesh.triangles.resize(static_cast<std::size_t>(counts[1]));
  file.read(reinterpret_cast<char*>(positions.data()),
            static_cast<std::streamsize>(positions.size() * sizeof(double)));
  file.read(reinterpret_cast<char*>(mesh.triangles.data()),
            static_cast<std::streamsize>(mesh.triangles.size() * sizeof(Triangle)));
  if (!file) throw std::runtime_error("the mesh cannot be read");
  for (std::size_t k = 0; k < positions.size(); k += 3) {
    mesh.points.emplace_back(positions[k], positions[k + 1], positions[k + 2]);
  }
  return mesh;
}

// The corner that two triangles with a common edge do not share is at the same place of `order`.
bool folded(const Mesh& mesh, const Triangle& first, const Triangle& second) {
  int own = 0;
  int other = 0;
  for (int k = 0; k < 3; ++k) {
    if (std::count(second.begin(), second.end(), first[static_cast<std::size_t>(k)]) == 0) own = k;
    if (std::count(first.begin(), first.end(), second[static_cast<std::size_t>(k)]) == 0) other = k;
  }
  const Point& a = mesh.corner(first, (own + 1) % 3);
  const Point& b = mesh.corner(first, (own + 2) % 3);
  const Point& c = mesh.corner(first, own);
  const Point& d = mesh.corner(second, other);
  return CGAL::coplanar(a, b, c, d) && CGAL::coplanar_orientation(a, b, c, d) == CGAL::POSITIVE;
}

bool cut_beyond(const Mesh& mesh, const Triangle& first, const Triangle& second,
                std::int64_t shared) {
  const auto k = static_cast<int>(std::find(first.begin(), first.end(), shared) - first.begin());
  const Kernel::Segment_3 opposite(mesh.corner(first, (k + 1) % 3),
                                   mesh.corner(first, (k + 2) % 3));
  return CGAL::do_intersect(mesh.shape(second), opposite);
}

bool intersect(const Mesh& mesh, const Triangle& first, const Triangle& second) {
  int common = 0;
  std::int64_t shared = -1;
  for (const std::int64_t vertex : first) {
    if (std::count(second.begin(), second.end(), vertex) == 0) continue;
    ++common;
    shared = vertex;
  }
  if (common == 3) return true;
  if (common == 2) return folded(mesh, first, second);
  if (common == 1) {
    return cut_beyond(mesh, first, second, shared) || cut_beyond(mesh, second, first, shared);
  }
  return CGAL::do_intersect(mesh.shape(first), mesh.shape(second));
}

void count(const Mesh& mesh) {
  std::vector<Box> boxes;
  long flat = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Kernel::Triangle_3 shape = mesh.shape(mesh.triangles[t]);
    if (shape.is_degenerate()) {
      ++flat;
    } else {
      boxes.emplace_back(shape.bbox(), t);
    }
  }
  long pairs = 0;
  std::vector<char> cut(mesh.triangles.size());
  std::array<long, 2> example{-1, -1};
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(),
                                [&](const Box& first, const Box& second) {
                                  const std::size_t a = first.info();
                                  const std::size_t b = second.info();
                                  if (!intersect(mesh, mesh.triangles[a], mesh.triangles[b]))
                                    return;
                                  if (pairs++ == 0)
                                    example = {static_cast<long>(a), static_cast<long>(b)};
                                  cut[a] = cut[b] = 1;
                                });
  std::printf("%ld %ld %ld %ld %ld\n", pairs,
              static_cast<long>(std::count(cut.begin(), cut.end(), 1)), flat, example[0],
              example[1]);
}

}  // namespace

int main(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) count(read(argv[k]));
}
