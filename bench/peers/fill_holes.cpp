// SPDX-License-Identifier: GPL-3.0-or-later

// CGAL's holes triangulated, refined and faired, for bench/voxels/holes.py. Needs Debian's
// libcgal-dev and libeigen3-dev:
//   c++ -O3 -DNDEBUG -std=c++17 -DCGAL_EIGEN3_ENABLED -I/usr/include/eigen3 -static \
//       bench/peers/fill_holes.cpp -o fill_holes -lmpfr -lgmp
// Usage: fill_holes IN.off OUT.off; prints the CPU seconds that it took. The mesh's own triangles
// are the first ones of OUT.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <ctime>
#include <fstream>
#include <iostream>
#include <iterator>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

int main(int count, char** arguments) {
  if (count != 3) return 2;
  Mesh mesh;
  if (!CGAL::IO::read_OFF(arguments[1], mesh)) return 1;
  const std::clock_t start = std::clock();
  std::vector<Mesh::Halfedge_index> borders;
  CGAL::Polygon_mesh_processing::extract_boundary_cycles(mesh, std::back_inserter(borders));
  for (const Mesh::Halfedge_index border : borders) {
    std::vector<Mesh::Face_index> faces;
    std::vector<Mesh::Vertex_index> vertices;
    CGAL::Polygon_mesh_processing::triangulate_refine_and_fair_hole(
        mesh, border, std::back_inserter(faces), std::back_inserter(vertices));
  }
  std::cout << static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC << '\n';
  std::ofstream target(arguments[2]);
  target.precision(17);
  return CGAL::IO::write_OFF(target, mesh) ? 0 : 1;
}
