// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "convert.h"
#include "instances.h"
#include "prefilter/geometry/corner_points.h"
#include "prefilter/geometry/measure_mesh.h"
#include "prefilter/geometry/nearest.h"
#include "prefilter/voxels/self_intersections.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

// Triangle, barycentric weights and distance for each point.
using Found = std::tuple<Array<std::int64_t>, Array<double>, Array<double>>;

Found point_arrays(const std::vector<SurfacePoint>& points) {
  const auto count = static_cast<py::ssize_t>(points.size());
  Array<std::int64_t> triangles(count);
  Array<double> weights({count, py::ssize_t{3}});
  Array<double> distances(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    const SurfacePoint& point = points[static_cast<std::size_t>(i)];
    triangles.mutable_at(i) = point.triangle;
    for (py::ssize_t c = 0; c < 3; ++c) {
      weights.mutable_at(i, c) = point.weights[static_cast<std::size_t>(c)];
    }
    distances.mutable_at(i) = point.distance;
  }
  return {std::move(triangles), std::move(weights), std::move(distances)};
}

std::unique_ptr<NearestPoints> bound_tree(const py::array& positions, const py::array& triangles,
                                          const py::object& callback, int threads) {
  const Run run = to_run(callback, threads);
  const InputMesh mesh = mesh_of(positions, triangles);
  const py::gil_scoped_release unlocked;
  return std::make_unique<NearestPoints>(mesh, run);
}

Found bound_find(const NearestPoints& tree, const Array<double>& points, const py::object& callback,
                 int threads) {
  const Run run = to_run(callback, threads);
  std::vector<SurfacePoint> nearest;
  {
    const py::gil_scoped_release unlocked;
    nearest = tree.find(rows_of(points), run);
  }
  return point_arrays(nearest);
}

Found bound_nearest_points(const Array<double>& points, const py::array& positions,
                           const py::array& triangles, const py::object& callback, int threads) {
  const Run run = to_run(callback, threads);
  const InputMesh mesh = mesh_of(positions, triangles);
  std::vector<SurfacePoint> nearest;
  {
    const py::gil_scoped_release unlocked;
    nearest = nearest_points(rows_of(points), mesh, run);
  }
  return point_arrays(nearest);
}

// Distinct points, and the index of each corner's point.
std::tuple<Found, Array<std::int32_t>> bound_corner_points(
    const py::array& positions, const py::array& triangles, const Array<std::int32_t>& origins,
    const py::array& source_positions, const py::array& source_triangles,
    const Array<std::int32_t>& labels, const py::object& callback, int threads) {
  const Run run = to_run(callback, threads);
  const InputMesh surface = mesh_of(positions, triangles);
  const InputMesh source = mesh_of(source_positions, source_triangles);
  CornerPoints corner_points;
  {
    const py::gil_scoped_release unlocked;
    corner_points = find_corner_points(surface, values_of(origins), source, values_of(labels), run);
  }
  const auto count = static_cast<py::ssize_t>(corner_points.corners.size());
  return {point_arrays(corner_points.points),
          to_array<std::int32_t>(std::move(corner_points.corners), {count, py::ssize_t{3}})};
}

std::tuple<std::pair<Vector3, Vector3>, double, double> bound_measure_mesh(
    const py::array& positions, const py::array& triangles, const py::object& callback,
    int threads) {
  const Run run = to_run(callback, threads);
  const InputMesh mesh = mesh_of(positions, triangles);
  MeshMeasures measures;
  {
    const py::gil_scoped_release unlocked;
    measures = measure_mesh(mesh, run);
  }
  return {{measures.box.low, measures.box.high}, measures.area, measures.volume};
}

Array<std::int64_t> bound_self_intersections(const py::array& positions, const py::array& triangles,
                                             const py::object& callback, int threads) {
  const Run run = to_run(callback, threads);
  const InputMesh mesh = mesh_of(positions, triangles);
  std::vector<std::array<std::uint32_t, 2>> pairs;
  {
    const py::gil_scoped_release unlocked;
    pairs = self_intersections(mesh, run);
  }
  Array<std::int64_t> rows({static_cast<py::ssize_t>(pairs.size()), py::ssize_t{2}});
  std::int64_t* next = rows.mutable_data();
  for (const auto& pair : pairs) next = std::copy(pair.begin(), pair.end(), next);
  return rows;
}

}  // namespace

void bind_spatial(py::module_& m) {
  py::class_<NearestPoints>(m, "NearestPoints")
      .def(py::init(&bound_tree), py::arg("positions"), py::arg("triangles"), py::arg("progress"),
           py::arg("threads"))
      .def("find", &bound_find, py::arg("points"), py::arg("progress"), py::arg("threads"));
  m.def("corner_points", &bound_corner_points, py::arg("positions"), py::arg("triangles"),
        py::arg("origins"), py::arg("source_positions"), py::arg("source_triangles"),
        py::arg("labels"), py::arg("progress"), py::arg("threads"));
  m.def("measure_mesh", &bound_measure_mesh, py::arg("positions"), py::arg("triangles"),
        py::arg("progress"), py::arg("threads"));
  m.def("self_intersections", &bound_self_intersections, py::arg("positions"), py::arg("triangles"),
        py::arg("progress"), py::arg("threads"));
  m.def("nearest_points", &bound_nearest_points, py::arg("points"), py::arg("positions"),
        py::arg("triangles"), py::arg("progress"), py::arg("threads"));
}

}  // namespace prefilter::python
