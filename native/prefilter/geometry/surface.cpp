// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/error.h"
#include "prefilter/base/text.h"

namespace prefilter {
namespace {

void check_finite(const double* values, std::size_t rows, std::size_t columns,
                  const std::string& what, const std::string& row_name) {
  for (std::size_t i = 0; i < rows * columns; ++i) {
    if (!std::isfinite(values[i])) {
      std::string message = what;
      message += ": " + row_name + " " + std::to_string(i / columns) + " holds ";
      message += to_text(values[i]) + "; all values must be finite";
      throw_invalid(message);
    }
  }
}

// A normal with the length of twice the triangle's area.
Vector3 triangle_normal(const Surface& surface, std::size_t k) {
  const auto& [a, b, c] = surface.triangles[k];
  const std::vector<Vector3>& points = surface.positions;
  return cross(points[b] - points[a], points[c] - points[a]);
}

void check_area(double area, const char* argument, std::size_t triangle) {
  if (!std::isfinite(area)) {
    throw_invalid(std::string(argument) + ": the area of triangle " + std::to_string(triangle) +
                  " is too large for a floating-point number");
  }
}

void check_weights(const TexturedMesh& mesh) {
  const bool of_vertices = mesh.weights_of == WeightsOf::kVertices;
  const bool of_corners = mesh.weights_of == WeightsOf::kCorners;
  const std::size_t columns = of_corners ? 3 : 1;
  const std::size_t rows = of_vertices ? mesh.mesh.positions.size() : mesh.mesh.triangles.size();
  for (std::size_t i = 0; i < rows * columns; ++i) {
    const double weight = mesh.weights[i];
    if (!std::isfinite(weight) || weight < 0.0) {
      throw_invalid(std::string("weights: ") + (of_vertices ? "vertex " : "triangle ") +
                    std::to_string(i / columns) + " has " + to_text(weight) +
                    "; finite weights of 0 and up are needed");
    }
  }
}

double weight_of(const TexturedMesh& mesh, std::size_t triangle) {
  const auto mean = [](double a, double b, double c) { return a / 3.0 + b / 3.0 + c / 3.0; };
  const auto& vertices = mesh.mesh.triangles[triangle];
  const double* weights = mesh.weights;
  switch (mesh.weights_of) {
    case WeightsOf::kNothing:
      return 1.0;
    case WeightsOf::kVertices:
      return mean(weights[vertices[0]], weights[vertices[1]], weights[vertices[2]]);
    case WeightsOf::kTriangles:
      return weights[triangle];
    case WeightsOf::kCorners:
      return mean(weights[3 * triangle], weights[3 * triangle + 1], weights[3 * triangle + 2]);
  }
  return 1.0;
}

// The cofactors of a linear map, which transform area vectors.
std::array<Vector3, 3> cofactors(const AffineMap& map) {
  const auto row = [&](int i) { return Vector3{map[i][0], map[i][1], map[i][2]}; };
  return {cross(row(1), row(2)), cross(row(2), row(0)), cross(row(0), row(1))};
}

Vector3 apply(const std::array<Vector3, 3>& rows, const Vector3& v) {
  return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)};
}

}  // namespace

double Surface::total_area() const { return std::accumulate(areas.begin(), areas.end(), 0.0); }

Surface make_surface(const TexturedMesh& textured, const Run& run) {
  const InputMesh& mesh = textured.mesh;
  const std::size_t count = mesh.triangles.size();
  check_mesh(mesh, std::numeric_limits<double>::max());
  check_finite(textured.uvs, count, 6, "uvs", "triangle");
  if (textured.weights_of != WeightsOf::kNothing) check_weights(textured);

  Surface surface;
  surface.uvs.resize(count);
  surface.areas.resize(count);
  surface.triangles.resize(count);
  CancelCheck cancel_check(run);
  surface.positions.reserve(mesh.positions.size());
  for (const Vector3& position : mesh.positions) surface.positions.push_back(position);
  for (std::size_t k = 0; k < count; ++k) {
    cancel_check.step();
    for (int corner = 0; corner < 3; ++corner) {
      surface.triangles[k][corner] = static_cast<std::int32_t>(mesh.triangles[k][corner]);
      const double* uv = textured.uvs + 6 * k + 2 * corner;
      surface.uvs[k][corner] = {uv[0], uv[1]};
    }
    const double area = 0.5 * length(triangle_normal(surface, k));
    check_area(area, "positions", k);
    surface.areas[k] = area * weight_of(textured, k);
    check_area(surface.areas[k], "weights", k);
  }
  return surface;
}

Surface place_surface(const Surface& surface, std::span<const AffineMap> maps) {
  if (maps.empty()) throw_invalid("matrices: none; at least one is needed");
  for (std::size_t i = 0; i < maps.size(); ++i) {
    check_finite(maps[i][0].data(), 1, 12, "matrices: matrix " + std::to_string(i), "row");
  }
  std::vector<std::array<Vector3, 3>> normal_maps(maps.size());
  std::transform(maps.begin(), maps.end(), normal_maps.begin(), cofactors);

  Surface placed = surface;
  for (std::size_t k = 0; k < surface.triangle_count(); ++k) {
    const Vector3 normal = triangle_normal(surface, k);
    const double before = length(normal);
    if (before == 0.0) continue;  // triangles without area stay flat
    double after = 0.0;
    for (const std::array<Vector3, 3>& map : normal_maps) after += length(apply(map, normal));
    placed.areas[k] = surface.areas[k] * (after / before);
    check_area(placed.areas[k], "matrices", k);
  }
  for (Vector3& position : placed.positions) {
    Vector3 moved;
    for (int i = 0; i < 3; ++i) {
      const std::array<double, 4>& row = maps[0][i];
      moved[i] = row[0] * position[0] + row[1] * position[1] + row[2] * position[2] + row[3];
      if (!std::isfinite(moved[i])) {
        throw_invalid("matrices: matrix 0 takes a vertex beyond the largest floating-point number");
      }
    }
    position = moved;
  }
  return placed;
}

bool same_layout(const Surface& a, const Surface& b) {
  const auto same_uvs = [](const std::array<TextureCoordinate, 3>& first,
                           const std::array<TextureCoordinate, 3>& second) {
    return std::equal(first.begin(), first.end(), second.begin(),
                      [](const TextureCoordinate& p, const TextureCoordinate& q) {
                        return p.u == q.u && p.v == q.v;
                      });
  };
  return a.positions.size() == b.positions.size() && a.triangles == b.triangles &&
         std::equal(a.uvs.begin(), a.uvs.end(), b.uvs.begin(), b.uvs.end(), same_uvs);
}

Surface add_areas(Surface surface, const Surface& other) {
  for (std::size_t k = 0; k < surface.triangle_count(); ++k) {
    surface.areas[k] += other.areas[k];
    check_area(surface.areas[k], "surfaces", k);
  }
  return surface;
}

}  // namespace prefilter
