#include <pybind11/stl.h>

#include <algorithm>
#include <cstring>
#include <tuple>
#include <type_traits>

#include "convert.h"
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

}  // namespace

void bind_solid(py::module_& m) {
  m.def("close_holes", &bound_close_holes, py::arg("positions"), py::arg("triangles"),
        py::arg("progress"));
}

}  // namespace prefilter::python
