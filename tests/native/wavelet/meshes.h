// SPDX-License-Identifier: GPL-3.0-or-later

// Small closed meshes, and their occupancies in closed form.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "prefilter/wavelet/triangle_analysis.h"

namespace prefilter::testing {

struct Mesh {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;

  RootTriangles view() const { return {{positions, triangles}}; }

  void add(const Mesh& other) {
    const auto offset = static_cast<std::int32_t>(positions.size());
    positions.insert(positions.end(), other.positions.begin(), other.positions.end());
    for (auto triangle : other.triangles) {
      for (auto& vertex : triangle) vertex += offset;
      triangles.push_back(triangle);
    }
  }
};

/// Corner i is high along x if bit 0 is set, along y for bit 1, along z for bit 2.
inline Mesh box_mesh(const Vector3& low, const Vector3& high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back({(i & 1) != 0 ? high[0] : low[0], (i & 2) != 0 ? high[1] : low[1],
                              (i & 4) != 0 ? high[2] : low[2]});
  }
  for (const auto& [a, b, c, d] :
       {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
        std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  return mesh;
}

/// A sphere of rings of triangles.
inline Mesh sphere_mesh(const Vector3& center, double radius, int rings) {
  Mesh mesh;
  const int columns = 2 * rings;
  const auto point = [&](int ring, int column) {
    const double theta = std::numbers::pi * ring / rings;
    const double phi = 2.0 * std::numbers::pi * column / columns;
    return Vector3{center[0] + radius * std::sin(theta) * std::cos(phi),
                   center[1] + radius * std::sin(theta) * std::sin(phi),
                   center[2] + radius * std::cos(theta)};
  };
  mesh.positions.push_back(point(0, 0));
  for (int ring = 1; ring < rings; ++ring) {
    for (int column = 0; column < columns; ++column) mesh.positions.push_back(point(ring, column));
  }
  mesh.positions.push_back(point(rings, 0));
  const auto last = static_cast<std::int32_t>(mesh.positions.size()) - 1;
  const auto index = [&](int ring, int column) {
    return 1 + (ring - 1) * columns + column % columns;
  };
  for (int column = 0; column < columns; ++column) {
    mesh.triangles.push_back({0, index(1, column), index(1, column + 1)});
    mesh.triangles.push_back({last, index(rings - 1, column + 1), index(rings - 1, column)});
    for (int ring = 1; ring + 1 < rings; ++ring) {
      const int a = index(ring, column);
      const int b = index(ring + 1, column);
      const int c = index(ring + 1, column + 1);
      const int d = index(ring, column + 1);
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

/// The share of the interval [cell, cell + 1) / n inside [low, high).
inline double covered(double low, double high, int cell, int n) {
  return std::clamp(std::min(high * n, cell + 1.0) - std::max(low * n, double(cell)), 0.0, 1.0);
}

}  // namespace prefilter::testing
