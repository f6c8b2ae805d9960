// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <cstring>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bind_options.h"
#include "convert.h"
#include "instances.h"
#include "prefilter/base/names.h"
#include "prefilter/geometry/charts.h"
#include "prefilter/geometry/polygon_triangles.h"
#include "prefilter/geometry/subdivision.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/geometry/udim_tile.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

WeightsOf weights_kind(const std::string& name) {
  if (name == "vertices") return WeightsOf::kVertices;
  if (name == "corners") return WeightsOf::kCorners;
  return WeightsOf::kTriangles;
}

template <typename T>
std::size_t length(const Array<T>& array) {
  return static_cast<std::size_t>(array.shape(0));
}

// A copy of a surface's rows, each an array or a struct of T only.
template <typename T, typename Row>
Array<T> rows(const std::vector<Row>& from, std::vector<py::ssize_t> row_shape) {
  row_shape.insert(row_shape.begin(), static_cast<py::ssize_t>(from.size()));
  Array<T> array(row_shape);
  if (!from.empty()) std::memcpy(array.mutable_data(), from.data(), from.size() * sizeof(Row));
  return array;
}

Surface bound_surface(const Array<double>& positions, const Array<std::int64_t>& triangles,
                      const Array<double>& uvs, const std::optional<Array<double>>& weights,
                      const std::string& weights_of) {
  TexturedMesh mesh;
  mesh.mesh = mesh_of(positions, triangles);
  mesh.uvs = uvs.data();
  if (weights) {
    mesh.weights = weights->data();
    mesh.weights_of = weights_kind(weights_of);
  }
  const py::gil_scoped_release unlocked;
  return make_surface(mesh);
}

Array<std::int32_t> bound_uv_charts(const py::array& positions, const py::array& triangles,
                                    const std::vector<Array<float>>& uvs,
                                    const py::object& callback, int threads) {
  const Run progress = to_run(callback, threads);
  const InputMesh mesh = mesh_of(positions, triangles);
  std::vector<CornerUvs> maps;
  for (const Array<float>& map : uvs) {
    maps.emplace_back(reinterpret_cast<const CornerUvs::value_type*>(map.data()),
                      static_cast<std::size_t>(map.shape(0)));
  }
  std::vector<std::int32_t> charts;
  {
    const py::gil_scoped_release unlocked;
    charts = find_charts(mesh, maps, progress);
  }
  return to_array<std::int32_t>(std::move(charts), {triangles.shape(0)});
}

Array<std::int64_t> bound_triangulate_polygons(const Array<double>& positions,
                                               const Array<std::int64_t>& corners,
                                               const Array<std::int64_t>& sizes,
                                               const py::object& callback) {
  const Run progress = to_run(callback);
  const PositionView points = rows_of(positions);
  std::vector<std::array<std::int64_t, 3>> triangles;
  {
    const py::gil_scoped_release unlocked;
    triangles = triangulate_polygons(points, {corners.data(), length(corners)},
                                     {sizes.data(), length(sizes)}, progress);
  }
  const auto count = static_cast<py::ssize_t>(triangles.size());
  return to_array<std::int64_t>(std::move(triangles), {count, 3});
}

Surface bound_placed(const Surface& surface, const Array<double>& matrices) {
  std::vector<AffineMap> maps(length(matrices));
  std::memcpy(maps.data(), matrices.data(), maps.size() * sizeof(AffineMap));
  const py::gil_scoped_release unlocked;
  return place_surface(surface, maps);
}

std::optional<Surface> bound_with_areas_of(const Surface& surface, const Surface& other) {
  const py::gil_scoped_release unlocked;
  if (!same_layout(surface, other)) return std::nullopt;
  return add_areas(surface, other);
}

std::optional<Surface> bound_udim_tile(const Surface& surface, int number) {
  const py::gil_scoped_release unlocked;
  Surface tile = udim_tile(surface, number);
  if (tile.triangle_count() == 0) return std::nullopt;
  return tile;
}

// The polygons of a PolygonArrays.
struct PolygonMesh {
  Array<double> positions;
  Array<std::int64_t> face_sizes;
  Array<std::int64_t> face_vertices;
  Array<double> face_uvs;
  Array<std::int64_t> crease_edges;
  Array<double> crease_sharpness;
  Array<std::int64_t> corner_vertices;
  Array<double> corner_sharpness;
  std::optional<Array<double>> weights;
  std::string weights_of;
  std::optional<Array<bool>> kept;
};

void bind_subdivision(py::module_& m) {
  using Options = SubdivisionOptions;
  auto bound = bind_options<Options, false>(m, "SubdivisionOptions");
  bind_named(bound, "scheme", &Options::scheme, kSubdivisionSchemes);
  bind_named(bound, "boundary", &Options::boundary, kSubdivisionBoundaries);
  bind_named(bound, "uv_smooth", &Options::uv_interpolation, kUvInterpolations);
  bound.def_readwrite("level", &Options::level);
  py::class_<PolygonMesh>(m, "PolygonMesh")
      .def(py::init<>())
      .def_readwrite("positions", &PolygonMesh::positions)
      .def_readwrite("face_sizes", &PolygonMesh::face_sizes)
      .def_readwrite("face_vertices", &PolygonMesh::face_vertices)
      .def_readwrite("face_uvs", &PolygonMesh::face_uvs)
      .def_readwrite("crease_edges", &PolygonMesh::crease_edges)
      .def_readwrite("crease_sharpness", &PolygonMesh::crease_sharpness)
      .def_readwrite("corner_vertices", &PolygonMesh::corner_vertices)
      .def_readwrite("corner_sharpness", &PolygonMesh::corner_sharpness)
      .def_readwrite("weights", &PolygonMesh::weights)
      .def_readwrite("weights_of", &PolygonMesh::weights_of)
      .def_readwrite("kept", &PolygonMesh::kept);
}

Surface bound_subdivide(const PolygonMesh& arrays, SubdivisionOptions options,
                        const py::object& progress) {
  PolygonArrays mesh;
  mesh.positions = arrays.positions.data();
  mesh.vertex_count = length(arrays.positions);
  mesh.face_sizes = arrays.face_sizes.data();
  mesh.face_count = length(arrays.face_sizes);
  mesh.face_vertices = arrays.face_vertices.data();
  mesh.face_uvs = arrays.face_uvs.data();
  mesh.corner_count = length(arrays.face_vertices);
  mesh.crease_edges = arrays.crease_edges.data();
  mesh.crease_sharpness = arrays.crease_sharpness.data();
  mesh.crease_count = length(arrays.crease_sharpness);
  mesh.corner_vertices = arrays.corner_vertices.data();
  mesh.corner_sharpness = arrays.corner_sharpness.data();
  mesh.sharp_corner_count = length(arrays.corner_sharpness);
  if (arrays.weights) {
    mesh.weights = arrays.weights->data();
    mesh.weights_of = weights_kind(arrays.weights_of);
  }
  if (arrays.kept) mesh.kept = arrays.kept->data();
  options.run = to_run(progress, options.run.threads());
  const py::gil_scoped_release unlocked;
  return subdivide(mesh, options);
}

}  // namespace

void bind_surface(py::module_& m) {
  py::class_<Surface, std::shared_ptr<Surface>>(m, "Surface")
      .def(py::init([](std::shared_ptr<Surface> shared) { return shared; }), py::arg("shared"))
      .def(py::init(&bound_surface), py::arg("positions"), py::arg("triangles"), py::arg("uvs"),
           py::arg("weights"), py::arg("weights_of"))
      .def("placed", &bound_placed, py::arg("matrices"))
      .def("with_areas_of", &bound_with_areas_of, py::arg("other"))
      .def("udim_tile", &bound_udim_tile, py::arg("number"))
      .def_property_readonly("triangle_count", &Surface::triangle_count)
      .def_property_readonly("area", &Surface::total_area)
      .def_property_readonly("positions",
                             [](const Surface& s) { return rows<double>(s.positions, {3}); })
      .def_property_readonly("triangles",
                             [](const Surface& s) { return rows<std::int32_t>(s.triangles, {3}); })
      .def_property_readonly("uvs",
                             [](const Surface& s) {
                               return rows<double>(s.uvs, {3, 2});
                             })
      .def_property_readonly("areas", [](const Surface& s) { return rows<double>(s.areas, {}); });
  m.def("uv_charts", &bound_uv_charts, py::arg("positions"), py::arg("triangles"), py::arg("uvs"),
        py::arg("progress"), py::arg("threads"));
  m.def("triangulate_polygons", &bound_triangulate_polygons, py::arg("positions"),
        py::arg("corners"), py::arg("sizes"), py::arg("progress"));
  bind_subdivision(m);
  m.def("subdivide", &bound_subdivide, py::arg("mesh"), py::arg("options"), py::arg("progress"));
}

}  // namespace prefilter::python
