// SPDX-License-Identifier: GPL-3.0-or-later

// Checks of contours.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter::testing {

/// Empty for a closed two-manifold without triangles of zero area or unused vertices: every edge
/// occurs once in each direction, and the triangles around each vertex form one fan.
inline std::string fault_of(const TriangleMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> thirds;
  std::vector<std::size_t> counts(mesh.positions.size());
  for (const auto& t : mesh.triangles) {
    std::array<Vector3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = mesh.positions.at(static_cast<std::size_t>(t[i]));
      ++counts[static_cast<std::size_t>(t[i])];
      if (!thirds.insert({{t[i], t[(i + 1) % 3]}, t[(i + 2) % 3]}).second) {
        return "an edge is there twice in one direction";
      }
    }
    if (!(length(cross(p[1] - p[0], p[2] - p[0])) > 0.0)) {
      return "a triangle has zero area";
    }
  }
  std::map<std::int32_t, std::int32_t> starts;
  for (const auto& [edge, third] : thirds) {
    if (!thirds.contains({edge.second, edge.first})) return "an edge is open";
    starts.insert({edge.first, edge.second});
  }
  for (std::size_t v = 0; v < counts.size(); ++v) {
    const auto vertex = static_cast<std::int32_t>(v);
    if (counts[v] == 0) return "a vertex has no triangle";
    std::int32_t at = starts.at(vertex);
    std::size_t count = 0;
    do {
      at = thirds.at({vertex, at});
      ++count;
    } while (at != starts.at(vertex) && count <= counts[v]);
    if (count != counts[v]) return "the triangles around a vertex are not one fan";
  }
  return "";
}

inline double volume_of(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    std::array<Vector3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = mesh.positions[static_cast<std::size_t>(t[i])];
    sum += dot(p[0], cross(p[1], p[2]));
  }
  return sum / 6.0;
}

}  // namespace prefilter::testing
