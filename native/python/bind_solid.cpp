#include <pybind11/stl.h>

#include <algorithm>
#include <cstring>
#include <tuple>
#include <type_traits>
#include <utility>

#include "convert.h"
#include "prefilter/solid/as_solid.h"
#include "prefilter/solid/close_holes.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

// The mesh with its caps, and the numbers of open edges and of holes.
std::tuple<Array<double>, Array<std::int64_t>, std::size_t, std::size_t> bound_close_holes(
    const Array<double>& positions, const Array<std::int64_t>& triangles,
    const py::object& callback) {
  const Progress progress = to_progress(callback);
  Caps caps;
  {
    const py::gil_scoped_release unlocked;
    caps = close_holes(mesh_of(positions, triangles), progress, 0);
  }
  const auto joined = [](const auto& own, const auto& added) {
    auto result = std::decay_t<decltype(own)>(
        {own.shape(0) + static_cast<py::ssize_t>(added.size()), py::ssize_t{3}});
    auto* const end = std::copy_n(own.data(), own.size(), result.mutable_data());
    if (!added.empty()) std::memcpy(end, added.data(), added.size() * sizeof(added[0]));
    return result;
  };
  return {joined(positions, caps.positions), joined(triangles, caps.triangles), caps.open_edges,
          caps.holes};
}

// Nothing where the mesh stays as it is, or its positions, triangles, and where these came from;
// and the report.
py::tuple bound_as_solid(const Array<double>& positions, const Array<std::int64_t>& triangles,
                         double cell, double weld, double gap, double thickness,
                         const py::object& callback, int threads) {
  SolidOptions options;
  options.cell = cell;
  options.weld = weld;
  options.gap = gap;
  options.thickness = thickness;
  options.threads = threads;
  options.progress = to_progress(callback);
  Solid solid;
  {
    const py::gil_scoped_release unlocked;
    solid = as_solid(mesh_of(positions, triangles), options);
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
                           report.filled_parts, report.lost_parts));
}

}  // namespace

void bind_solid(py::module_& m) {
  m.def("as_solid", &bound_as_solid, py::arg("positions"), py::arg("triangles"), py::arg("cell"),
        py::arg("weld"), py::arg("gap"), py::arg("thickness"), py::arg("progress"),
        py::arg("threads"));
  m.def("close_holes", &bound_close_holes, py::arg("positions"), py::arg("triangles"),
        py::arg("progress"));
}

}  // namespace prefilter::python
