// SPDX-License-Identifier: GPL-3.0-or-later

// Sutherland-Hodgman polygon clipping in barycentric coordinates, which measure areas even if
// texture coordinates are degenerate.
#include "prefilter/geometry/udim_tile.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

constexpr int kColumns = 10;

using Barycentric = std::array<double, 3>;
using TriangleUvs = std::array<TextureCoordinate, 3>;

struct Corner {
  Barycentric weights;
  double uv[2];  // relative to the tile: the unit square
};

// A triangle cut by four lines has at most seven corners.
struct Polygon {
  std::array<Corner, 8> corners;
  int count = 0;

  void push(const Corner& corner) { corners[count++] = corner; }
};

double coordinate(const TextureCoordinate& uv, int axis) { return axis == 0 ? uv.u : uv.v; }

// The fraction of the triangle between three of its points.
double share(const Corner& a, const Corner& b, const Corner& c) {
  return std::abs((b.weights[0] - a.weights[0]) * (c.weights[1] - a.weights[1]) -
                  (c.weights[0] - a.weights[0]) * (b.weights[1] - a.weights[1]));
}

class Clipper {
 public:
  Clipper(const Surface& surface, int column, int row) : surface_(surface), origin_{column, row} {
    vertex_map_.assign(surface.positions.size(), -1);
  }

  Surface run() {
    for (std::size_t k = 0; k < surface_.triangle_count(); ++k) add(k);
    return std::move(clipped_);
  }

 private:
  void add(std::size_t k) {
    triangle_ = k;
    Polygon polygon;
    for (int i = 0; i < 3; ++i) {
      Corner corner{};
      corner.weights[i] = 1.0;
      for (int axis = 0; axis < 2; ++axis) {
        corner.uv[axis] = coordinate(surface_.uvs[k][i], axis) - origin_[axis];
      }
      polygon.push(corner);
    }
    for (int axis = 0; axis < 2; ++axis) {
      if (is_beyond(polygon, axis)) return;
      if (is_flat_along(polygon, axis)) {
        if (!holds(polygon.corners[0].uv[axis], axis)) return;
      } else {
        polygon = cut(polygon, axis, 0.0, 1.0);
        polygon = cut(polygon, axis, 1.0, -1.0);
      }
    }
    std::array<std::int32_t, 8> vertices;
    vertices.fill(-1);
    for (int i = 2; i < polygon.count; ++i) add_part(polygon, {0, i - 1, i}, &vertices);
  }

  static bool is_beyond(const Polygon& polygon, int axis) {
    const auto corners = std::span(polygon.corners).first(polygon.count);
    return std::all_of(corners.begin(), corners.end(),
                       [axis](const Corner& corner) { return corner.uv[axis] < 0.0; }) ||
           std::all_of(corners.begin(), corners.end(),
                       [axis](const Corner& corner) { return corner.uv[axis] > 1.0; });
  }

  static bool is_flat_along(const Polygon& polygon, int axis) {
    const auto& corners = polygon.corners;
    return corners[0].uv[axis] == corners[1].uv[axis] && corners[1].uv[axis] == corners[2].uv[axis];
  }

  // The right edge belongs to the tile in the last column, as no tile follows.
  bool holds(double value, int axis) const {
    if (value == 1.0) return axis == 0 && origin_[0] == kColumns - 1;
    return value >= 0.0 && value < 1.0;
  }

  // The part of a polygon where direction * (uv[axis] - line) >= 0.
  Polygon cut(const Polygon& polygon, int axis, double line, double direction) const {
    Polygon part;
    for (int i = 0; i < polygon.count; ++i) {
      const Corner& a = polygon.corners[i];
      const Corner& b = polygon.corners[(i + 1) % polygon.count];
      const double from = direction * (a.uv[axis] - line);
      const double to = direction * (b.uv[axis] - line);
      if (from >= 0.0) part.push(a);
      if ((from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0)) {
        part.push(crossing(a, b, axis, line));
      }
    }
    return part;
  }

  Corner crossing(const Corner& a, const Corner& b, int axis, double line) const {
    for (int i = 0; i < 3; ++i) {
      if (a.weights[i] == 0.0 && b.weights[i] == 0.0) return edge_crossing(i, axis, line);
    }
    const double t = (line - a.uv[axis]) / (b.uv[axis] - a.uv[axis]);
    return between(a, b, t, axis, line);
  }

  // The intersection of an edge of the triangle with the line: bitwise the same for both triangles
  // of the edge if they have the same texture coordinates.
  Corner edge_crossing(int opposite, int axis, double line) const {
    int low = (opposite + 1) % 3;
    int high = (opposite + 2) % 3;
    const auto& vertices = surface_.triangles[triangle_];
    if (vertices[high] < vertices[low]) std::swap(low, high);
    const auto corner = [&](int i) {
      Corner result{};
      result.weights[i] = 1.0;
      for (int k = 0; k < 2; ++k) {
        result.uv[k] = coordinate(surface_.uvs[triangle_][i], k) - origin_[k];
      }
      return result;
    };
    const Corner a = corner(low);
    const Corner b = corner(high);
    return between(a, b, (line - a.uv[axis]) / (b.uv[axis] - a.uv[axis]), axis, line);
  }

  static Corner between(const Corner& a, const Corner& b, double t, int axis, double line) {
    Corner result{};
    for (int i = 0; i < 3; ++i) result.weights[i] = (1.0 - t) * a.weights[i] + t * b.weights[i];
    for (int k = 0; k < 2; ++k) result.uv[k] = (1.0 - t) * a.uv[k] + t * b.uv[k];
    result.uv[axis] = line;
    return result;
  }

  void add_part(const Polygon& polygon, const std::array<int, 3>& corner_indices,
                std::array<std::int32_t, 8>* known) {
    const auto& corners = polygon.corners;
    const double part =
        share(corners[corner_indices[0]], corners[corner_indices[1]], corners[corner_indices[2]]);
    if (part == 0.0) return;
    clipped_.areas.push_back(surface_.areas[triangle_] * part);
    std::array<std::int32_t, 3>& vertices = clipped_.triangles.emplace_back();
    TriangleUvs& uvs = clipped_.uvs.emplace_back();
    for (int i = 0; i < 3; ++i) {
      const Corner& corner = corners[corner_indices[i]];
      std::int32_t& id = (*known)[corner_indices[i]];
      if (id < 0) id = vertex(corner);
      vertices[i] = id;
      // After a cut along one axis, the other coordinate may be slightly off the tile due to
      // rounding.
      uvs[i] = {std::clamp(corner.uv[0], 0.0, 1.0), std::clamp(corner.uv[1], 0.0, 1.0)};
    }
  }

  std::int32_t vertex(const Corner& corner) {
    const auto& vertices = surface_.triangles[triangle_];
    for (int i = 0; i < 3; ++i) {
      if (corner.weights[i] == 1.0) {
        std::int32_t& known = vertex_map_[vertices[i]];
        if (known < 0) known = new_vertex(corner);
        return known;
      }
    }
    for (int i = 0; i < 3; ++i) {
      if (corner.weights[i] != 0.0) continue;
      int low = (i + 1) % 3;
      int high = (i + 2) % 3;
      if (vertices[high] < vertices[low]) std::swap(low, high);
      const auto [result, is_new] =
          edge_vertices_.try_emplace({vertices[low], vertices[high], corner.weights[high]}, 0);
      if (is_new) result->second = new_vertex(corner);
      return result->second;
    }
    return new_vertex(corner);
  }

  std::int32_t new_vertex(const Corner& corner) {
    Vector3 position{};
    for (int i = 0; i < 3; ++i) {
      const auto& from = surface_.positions[surface_.triangles[triangle_][i]];
      for (int axis = 0; axis < 3; ++axis) position[axis] += corner.weights[i] * from[axis];
    }
    clipped_.positions.push_back(position);
    return static_cast<std::int32_t>(clipped_.positions.size() - 1);
  }

  const Surface& surface_;
  std::array<int, 2> origin_;
  Surface clipped_;
  std::size_t triangle_ = 0;  // the triangle being clipped
  std::vector<std::int32_t> vertex_map_;
  // Keys: the edge's lower and higher vertex, and the fraction of the way from the lower one.
  std::map<std::tuple<std::int32_t, std::int32_t, double>, std::int32_t> edge_vertices_;
};

}  // namespace

Surface udim_tile(const Surface& surface, int number) {
  if (number < kFirstUdimTile || number > kLastUdimTile) {
    throw_invalid("number: " + std::to_string(number) + "; a UDIM tile has a number from " +
                  std::to_string(kFirstUdimTile) + " to " + std::to_string(kLastUdimTile));
  }
  const int index = number - kFirstUdimTile;
  return Clipper(surface, index % kColumns, index / kColumns).run();
}

}  // namespace prefilter
