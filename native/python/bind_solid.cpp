// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bind_options.h"
#include "convert.h"
#include "prefilter/base/error.h"
#include "prefilter/base/names.h"
#include "prefilter/voxels/as_solid.h"
#include "prefilter/voxels/close_holes.h"
#include "prefilter/voxels/mesh_edges.h"
#include "prefilter/voxels/mesh_topology.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

// The mesh with its caps, or unchanged without any; and the numbers of open edges, of holes, and of
// holes left open.
std::tuple<py::array, py::array, std::size_t, std::size_t, std::size_t> bound_close_holes(
    const py::array& positions, const py::array& triangles, const std::string& method,
    const py::object& callback, int threads) {
  CloseHolesOptions options;
  options.method = value_named("method", method, kHoleMethods);
  options.run = to_run(callback, threads);
  const InputMesh mesh = mesh_of(positions, triangles);
  Caps caps;
  {
    const py::gil_scoped_release unlocked;
    caps = close_holes(mesh, options);
  }
  if (caps.triangles.empty()) {
    return {positions, triangles, caps.open_edges, caps.holes, caps.left_open};
  }
  const auto joined = []<typename T>(const auto& own, const std::vector<std::array<T, 3>>& added) {
    Array<T> result({static_cast<py::ssize_t>(own.size() + added.size()), py::ssize_t{3}});
    auto* const rows = reinterpret_cast<std::array<T, 3>*>(result.mutable_data());
    for (std::size_t i = 0; i < own.size(); ++i) rows[i] = own[i];
    std::copy(added.begin(), added.end(), rows + own.size());
    return result;
  };
  return {joined(mesh.positions, caps.positions), joined(mesh.triangles, caps.triangles),
          caps.open_edges, caps.holes, caps.left_open};
}

// None if the mesh is unchanged, otherwise positions, triangles and their source triangles; and the
// report.
py::tuple bound_as_solid(const py::array& positions, const py::array& triangles,
                         SolidOptions options, const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const InputMesh mesh_view = mesh_of(positions, triangles);
  Solid solid;
  {
    const py::gil_scoped_release unlocked;
    solid = as_solid(mesh_view, options);
  }
  py::object mesh = py::none();
  if (!solid.is_unchanged) {
    const auto vertices = static_cast<py::ssize_t>(solid.positions.size());
    const auto count = static_cast<py::ssize_t>(solid.triangles.size());
    mesh = py::make_tuple(to_array<double>(std::move(solid.positions), {vertices, 3}),
                          to_array<std::int64_t>(std::move(solid.triangles), {count, 3}),
                          to_array<std::int64_t>(std::move(solid.origins), {count}));
  }
  const SolidReport& report = solid.report;
  return py::make_tuple(
      mesh, py::make_tuple(report.parts, report.welded_vertices, report.duplicate_faces,
                           report.turned_faces, report.turned_parts, report.thickened_parts,
                           report.filled_parts));
}

// The vertices of edges, and the edge at each corner.
std::pair<Array<std::int32_t>, Array<std::int32_t>> bound_mesh_edges(const py::array& positions,
                                                                     const py::array& triangles,
                                                                     const py::object& callback,
                                                                     int threads) {
  const Run progress = to_run(callback, threads);
  const InputMesh mesh = mesh_of(positions, triangles);
  MeshEdges edges;
  {
    const py::gil_scoped_release unlocked;
    edges = find_mesh_edges(mesh, progress);
  }
  const auto count = static_cast<py::ssize_t>(edges.vertices.size());
  const auto corners = static_cast<py::ssize_t>(edges.of_corners.size());
  return {to_array<std::int32_t>(std::move(edges.vertices), {count, py::ssize_t{2}}),
          to_array<std::int32_t>(std::move(edges.of_corners), {corners / 3, py::ssize_t{3}})};
}

// The numbers of parts, of cavities and of borders, the genus, the edges of borders, and the part
// of each triangle.
std::tuple<std::size_t, std::size_t, std::size_t, std::optional<std::size_t>, Array<std::int32_t>,
           Array<std::int32_t>>
bound_mesh_topology(const py::array& positions, const py::array& triangles, bool welds,
                    const py::object& callback, int threads) {
  const Run progress = to_run(callback, threads);
  const InputMesh mesh = mesh_of(positions, triangles);
  MeshTopology topology;
  {
    const py::gil_scoped_release unlocked;
    topology = mesh_topology(mesh, welds, progress);
  }
  const auto count = static_cast<py::ssize_t>(topology.part_of.size());
  const auto edges = static_cast<py::ssize_t>(topology.border_edges.size());
  return {topology.parts,
          topology.cavities,
          topology.borders,
          topology.genus,
          to_array<std::int32_t>(std::move(topology.border_edges), {edges, py::ssize_t{2}}),
          to_array<std::int32_t>(std::move(topology.part_of), {count})};
}

}  // namespace

void bind_solid(py::module_& m) {
  auto options = bind_options<SolidOptions>(m, "SolidOptions");
  options.def_readwrite("cell", &SolidOptions::cell)
      .def_readwrite("weld", &SolidOptions::weld)
      .def_readwrite("gap", &SolidOptions::gap)
      .def_readwrite("thickness", &SolidOptions::thickness);
  bind_named(options, "sheets", &SolidOptions::sheets, kSheetMethods);
  m.def("as_solid", &bound_as_solid, py::arg("positions"), py::arg("triangles"), py::arg("options"),
        py::arg("progress"));
  m.def("close_holes", &bound_close_holes, py::arg("positions"), py::arg("triangles"),
        py::arg("method"), py::arg("progress"), py::arg("threads"));
  m.def("mesh_edges", &bound_mesh_edges, py::arg("positions"), py::arg("triangles"),
        py::arg("progress"), py::arg("threads"));
  m.def("mesh_topology", &bound_mesh_topology, py::arg("positions"), py::arg("triangles"),
        py::arg("welds"), py::arg("progress"), py::arg("threads"));
}

}  // namespace prefilter::python
