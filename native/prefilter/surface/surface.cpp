#include "prefilter/surface/surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

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

double triangle_area(const double* a, const double* b, const double* c) {
  const double ab[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const double ac[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  const double normal[3] = {ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                            ab[0] * ac[1] - ab[1] * ac[0]};
  return 0.5 * std::hypot(normal[0], normal[1], normal[2]);
}

}  // namespace

double Surface::total_area() const { return std::accumulate(areas.begin(), areas.end(), 0.0); }

Surface make_surface(const MeshArrays& mesh) {
  if (mesh.triangle_count == 0) {
    throw_invalid("triangles: the mesh has no faces; at least one triangle is needed");
  }
  check_finite(mesh.positions, mesh.vertex_count, 3, "positions", "vertex");
  check_finite(mesh.uvs, mesh.triangle_count, 6, "uvs", "triangle");

  Surface surface;
  surface.uvs.resize(mesh.triangle_count);
  surface.areas.resize(mesh.triangle_count);
  surface.triangles.resize(mesh.triangle_count);
  surface.positions.resize(mesh.vertex_count);
  for (std::size_t i = 0; i < mesh.vertex_count; ++i) {
    std::copy_n(mesh.positions + 3 * i, 3, surface.positions[i].data());
  }
  for (std::size_t k = 0; k < mesh.triangle_count; ++k) {
    const std::int64_t* vertices = mesh.triangles + 3 * k;
    for (int corner = 0; corner < 3; ++corner) {
      const std::int64_t vertex = vertices[corner];
      if (vertex < 0 || vertex >= static_cast<std::int64_t>(mesh.vertex_count)) {
        throw_invalid("triangles: triangle " + std::to_string(k) + " names vertex " +
                      std::to_string(vertex) + ", but there are " +
                      std::to_string(mesh.vertex_count) + " vertices (0 to " +
                      std::to_string(static_cast<std::int64_t>(mesh.vertex_count) - 1) + ")");
      }
      surface.triangles[k][corner] = static_cast<std::int32_t>(vertex);
      const double* uv = mesh.uvs + 6 * k + 2 * corner;
      surface.uvs[k][corner] = {uv[0], uv[1]};
    }
    surface.areas[k] =
        triangle_area(mesh.positions + 3 * vertices[0], mesh.positions + 3 * vertices[1],
                      mesh.positions + 3 * vertices[2]);
    if (!std::isfinite(surface.areas[k])) {
      throw_invalid("positions: the area of triangle " + std::to_string(k) +
                    " is too large for a floating-point number");
    }
  }
  return surface;
}

}  // namespace prefilter
