// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/geometry.h"

#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"

namespace prefilter {

void check_points(const PositionView& points, const char* rows, double largest) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const double x : points[i]) {
      if (std::abs(x) <= largest) continue;
      const bool is_limited = largest < std::numeric_limits<double>::max();
      throw_invalid(std::string(rows) + " " + std::to_string(i) + " holds " + to_text(x) +
                    "; all values must be finite" +
                    (is_limited ? ", and at most " + to_text(largest) : ""));
    }
  }
}

void throw_no_vertex(const std::string& who, std::int64_t vertex, std::size_t count) {
  throw_invalid(who + " names vertex " + std::to_string(vertex) + ", but there are " +
                std::to_string(count) + " vertices (0 to " +
                std::to_string(static_cast<std::int64_t>(count) - 1) + ")");
}

void check_mesh(const InputMesh& mesh, double largest) {
  if (mesh.triangles.empty()) throw_invalid("triangles: none; at least one is needed");
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max() ||
      mesh.positions.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw_invalid("triangles: too many; 2^32 triangles and 2^31 positions are the most");
  }
  check_points(mesh.positions, "positions: vertex", largest);
  const auto count = static_cast<std::int64_t>(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::int64_t vertex : mesh.triangles[t]) {
      if (vertex >= 0 && vertex < count) continue;
      throw_no_vertex("triangles: triangle " + std::to_string(t), vertex, mesh.positions.size());
    }
  }
}

void check_box(const Box& box, const char* argument) {
  for (int a = 0; a < 3; ++a) {
    if (std::abs(box.low[a]) <= kLargestCoordinate && std::abs(box.high[a]) <= kLargestCoordinate &&
        box.low[a] + box.size(a) / 4096.0 > box.low[a]) {
      continue;
    }
    throw_invalid(std::string(argument) + ": from " + to_text(box.low[a]) + " to " +
                  to_text(box.high[a]) + " along " + std::string(1, "xyz"[a]) +
                  "; finite corners are needed, the high one above the low one");
  }
}

}  // namespace prefilter
