// SPDX-License-Identifier: GPL-3.0-or-later

// CGAL's alpha wrap of a triangle soup, for bench/voxels/hard.py. Needs Debian's libcgal-dev:
//   c++ -O3 -DNDEBUG -std=c++17 bench/peers/alpha_wrap.cpp -o alpha_wrap -lgmp -lmpfr
// Usage: alpha_wrap IN.off OUT.off ALPHA OFFSET (lengths); prints the CPU seconds that it took.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <array>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

int main(int count, char** arguments) {
  if (count != 5) return 2;
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  if (!CGAL::IO::read_polygon_soup(arguments[1], points, triangles)) return 1;
  const std::clock_t start = std::clock();
  CGAL::Surface_mesh<Kernel::Point_3> wrap;
  CGAL::alpha_wrap_3(points, triangles, std::atof(arguments[3]), std::atof(arguments[4]), wrap);
  std::cout << static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC << '\n';
  std::ofstream target(arguments[2]);
  target.precision(17);
  return CGAL::IO::write_OFF(target, wrap) ? 0 : 1;
}
