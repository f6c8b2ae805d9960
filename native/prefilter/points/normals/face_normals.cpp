// SPDX-License-Identifier: GPL-3.0-or-later

// Normals by area, and the weights of Curless and Levoy, A Volumetric Method for Building Complex
// Models from Range Images (1996).
#include "prefilter/points/face_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/error.h"

namespace prefilter {
namespace {

constexpr double kMaxEdgeRatio = 4.0;  // multiples of the median
constexpr int kBorderSteps = 6;        // grid cells over which weights fall off

using Triangle = std::array<std::int64_t, 3>;

double distance(const Vector3& a, const Vector3& b) { return length(a - b); }

Vector3 unit_or_none(const Vector3& v) {
  const double size = length(v);
  if (!(size > 0.0) || !std::isfinite(size)) return {};
  return {v[0] / size, v[1] / size, v[2] / size};
}

// A range grid with valid indices, and its triangles.
class ScanGrid {
 public:
  ScanGrid(std::span<const Vector3> points, const RangeGrid& grid) : points_(points), grid_(grid) {
    const bool is_whole =
        grid.rows >= 0 && grid.columns >= 0 &&
        static_cast<std::size_t>(grid.rows) * static_cast<std::size_t>(grid.columns) ==
            grid.points.size();
    if (!is_whole) {
      throw_invalid("grid: found " + std::to_string(grid.points.size()) + " places for " +
                    std::to_string(grid.rows) + " rows of " + std::to_string(grid.columns));
    }
    const auto count = static_cast<std::int64_t>(points.size());
    for (std::size_t i = 0; i < grid.points.size(); ++i) {
      if (grid.points[i] >= -1 && grid.points[i] < count) continue;
      throw_invalid("grid: place " + std::to_string(i) + " names point " +
                    std::to_string(grid.points[i]) + "; there are " + std::to_string(count) +
                    ", numbered from 0, and -1 stands for none");
    }
  }

  std::int64_t rows() const { return grid_.rows; }
  std::int64_t columns() const { return grid_.columns; }
  std::int64_t point(std::int64_t row, std::int64_t column) const {
    return grid_.points[static_cast<std::size_t>(row * grid_.columns + column)];
  }
  const Vector3& position(std::int64_t point) const {
    return points_[static_cast<std::size_t>(point)];
  }

  // Median distance of neighbors in rows and columns; 0 if there are none.
  double spacing(const Run& run) const {
    std::vector<double> lengths;
    CancelCheck cancel_check(run);
    for (std::int64_t row = 0; row < rows(); ++row) {
      for (std::int64_t column = 0; column < columns(); ++column) {
        cancel_check.step();
        if (column + 1 < columns())
          add_length(point(row, column), point(row, column + 1), &lengths);
        if (row + 1 < rows()) add_length(point(row, column), point(row + 1, column), &lengths);
      }
    }
    if (lengths.empty()) return 0.0;
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    return *middle;
  }

  // The triangles of the cell whose first corner this is: two, or fewer if a corner is missing or
  // too far. They wind from columns to rows.
  int triangles(std::int64_t row, std::int64_t column, double longest,
                std::array<Triangle, 2>* triangles_of_cell) const {
    const std::array<std::int64_t, 4> corners = {point(row, column), point(row, column + 1),
                                                 point(row + 1, column + 1),
                                                 point(row + 1, column)};
    // Splits the cell along its shorter diagonal, or beside a missing corner.
    const double first = gap(corners[0], corners[2]);
    const double second = gap(corners[1], corners[3]);
    const std::size_t turn = first <= second ? 0 : 1;
    int count = 0;
    for (const std::size_t skipped : {turn + 3, turn + 1}) {
      const Triangle triangle = {corners[(skipped + 1) % 4], corners[(skipped + 2) % 4],
                                 corners[(skipped + 3) % 4]};
      const bool is_near = gap(triangle[0], triangle[1]) <= longest &&
                           gap(triangle[1], triangle[2]) <= longest &&
                           gap(triangle[2], triangle[0]) <= longest;
      if (is_near) (*triangles_of_cell)[static_cast<std::size_t>(count++)] = triangle;
    }
    return count;
  }

 private:
  // Distance of two points; infinite if one is missing or not finite.
  double gap(std::int64_t a, std::int64_t b) const {
    if (a < 0 || b < 0) return std::numeric_limits<double>::infinity();
    const double size = distance(position(a), position(b));
    return std::isfinite(size) ? size : std::numeric_limits<double>::infinity();
  }

  void add_length(std::int64_t a, std::int64_t b, std::vector<double>* lengths) const {
    const double size = gap(a, b);
    if (std::isfinite(size)) lengths->push_back(size);
  }

  std::span<const Vector3> points_;
  const RangeGrid& grid_;
};

// Distance of each grid position from the end of the surface, in steps up to kBorderSteps: two
// passes of a chamfer distance transform.
std::vector<std::int8_t> steps_to_end(std::int64_t rows, std::int64_t columns,
                                      const std::vector<bool>& is_end, const Run& run) {
  std::vector<std::int8_t> steps(is_end.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i] = is_end[i] ? 0 : static_cast<std::int8_t>(kBorderSteps);
  }
  CancelCheck cancel_check(run);
  const auto update = [&](std::int64_t row, std::int64_t column, std::int64_t along) {
    cancel_check.step();
    std::int8_t& own = steps[static_cast<std::size_t>(row * columns + column)];
    // The neighbors visited before: one in this row, three in the previous row.
    const std::array<std::array<std::int64_t, 2>, 4> before = {{{row, column - along},
                                                                {row - along, column - 1},
                                                                {row - along, column},
                                                                {row - along, column + 1}}};
    for (const auto& [r, c] : before) {
      if (r < 0 || r >= rows || c < 0 || c >= columns) continue;
      const int next = steps[static_cast<std::size_t>(r * columns + c)] + 1;
      own = static_cast<std::int8_t>(std::min<int>(own, next));
    }
  };
  for (std::int64_t row = 0; row < rows; ++row) {
    for (std::int64_t column = 0; column < columns; ++column) update(row, column, 1);
  }
  for (std::int64_t row = rows; row-- > 0;) {
    for (std::int64_t column = columns; column-- > 0;) update(row, column, -1);
  }
  return steps;
}

}  // namespace

std::vector<Vector3> mesh_normals(const InputMesh& mesh, const Run& run) {
  std::vector<Vector3> normals(mesh.positions.size());
  const auto count = static_cast<std::int64_t>(mesh.positions.size());
  CancelCheck cancel_check(run);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    cancel_check.step();
    for (const std::int64_t vertex : mesh.triangles[t]) {
      if (vertex >= 0 && vertex < count) continue;
      throw_no_vertex("triangles: triangle " + std::to_string(t), vertex, mesh.positions.size());
    }
    const auto& [a, b, c] = mesh.corners(t);
    const Vector3 twice_area = cross(b - a, c - a);
    for (const std::int64_t vertex : mesh.triangles[t]) {
      Vector3& normal = normals[static_cast<std::size_t>(vertex)];
      normal = normal + twice_area;
    }
  }
  for (Vector3& normal : normals) {
    cancel_check.step();
    normal = unit_or_none(normal);
  }
  return normals;
}

GridNormals grid_normals(std::span<const Vector3> points, const RangeGrid& grid,
                         const std::optional<Vector3>& viewpoint, const Run& run) {
  if (viewpoint) check_points(std::span(&*viewpoint, 1), "viewpoint: row", kLargestCoordinate);
  const ScanGrid places(points, grid);
  const double longest = kMaxEdgeRatio * places.spacing(run);
  std::vector<Triangle> triangles;
  // A position is at the end of the surface unless all four cells around it are complete.
  std::vector<bool> is_end(grid.points.size(), true);
  std::vector<std::uint8_t> whole_cells(grid.points.size());
  CancelCheck cancel_check(run);
  for (std::int64_t row = 0; row + 1 < places.rows(); ++row) {
    for (std::int64_t column = 0; column + 1 < places.columns(); ++column) {
      cancel_check.step();
      std::array<Triangle, 2> cell_triangles;
      const int count = places.triangles(row, column, longest, &cell_triangles);
      triangles.insert(triangles.end(), cell_triangles.begin(), cell_triangles.begin() + count);
      if (count < 2) continue;
      const auto first = static_cast<std::size_t>(row * places.columns() + column);
      const auto below = first + static_cast<std::size_t>(places.columns());
      for (const std::size_t place : {first, first + 1, below, below + 1}) {
        is_end[place] = ++whole_cells[place] < 4;
      }
    }
  }
  GridNormals result;
  result.normals = mesh_normals({points, triangles}, run);
  const auto toward = [&](std::size_t i) {
    return viewpoint ? unit_or_none(*viewpoint - points[i]) : Vector3{0.0, 0.0, 1.0};
  };
  double visible = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    cancel_check.step();
    if (result.normals[i] != Vector3{}) visible += dot(result.normals[i], toward(i));
  }
  if (visible < 0.0) {
    for (Vector3& normal : result.normals) normal = Vector3{} - normal;
  }
  const std::vector<std::int8_t> steps = steps_to_end(places.rows(), places.columns(), is_end, run);
  result.weights.resize(points.size());
  for (std::size_t place = 0; place < grid.points.size(); ++place) {
    cancel_check.step();
    if (grid.points[place] < 0) continue;
    const auto i = static_cast<std::size_t>(grid.points[place]);
    if (result.normals[i] == Vector3{}) continue;
    const double cosine = std::clamp(dot(result.normals[i], toward(i)), 0.0, 1.0);
    result.weights[i] = static_cast<float>(cosine * (steps[place] + 1) / (kBorderSteps + 1));
  }
  run.report(1.0);
  return result;
}

}  // namespace prefilter
