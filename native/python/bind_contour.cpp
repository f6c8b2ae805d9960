// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bind_options.h"
#include "convert.h"
#include "instances.h"
#include "prefilter/base/error.h"
#include "prefilter/base/names.h"
#include "prefilter/voxels/grid_contour.h"
#include "prefilter/voxels/octree.h"
#include "prefilter/voxels/outlines.h"
#include "prefilter/voxels/quad_contour.h"
#include "prefilter/voxels/tree_contour.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

void bind_contour_options(py::module_& m) {
  using Options = ContourOptions;
  bind_options<Options>(m, "ContourOptions")
      .def_property("interpolant", nullptr,
                    [](Options& o, const std::string& name) {
                      o.interpolant = value_named("interpolant", name, kInterpolants);
                    })
      .def_readwrite("isovalue", &Options::isovalue)
      .def_readwrite("cleanup", &Options::clean_up)
      .def_readwrite("adaptivity", &Options::adaptivity);
}

using MeshArrays = std::pair<Array<double>, Array<std::int32_t>>;

MeshArrays mesh_arrays(TriangleMesh mesh) {
  const auto vertices = static_cast<py::ssize_t>(mesh.positions.size());
  const auto triangles = static_cast<py::ssize_t>(mesh.triangles.size());
  return {to_array<double>(std::move(mesh.positions), {vertices, 3}),
          to_array<std::int32_t>(std::move(mesh.triangles), {triangles, 3})};
}

// A mesh, and the groups of its triangles, which may be empty.
using SourceArrays = std::tuple<py::array, py::array, Array<std::int32_t>>;

std::vector<SourceMesh> sources_of(const std::vector<SourceArrays>& arrays) {
  std::vector<SourceMesh> sources;
  for (const auto& [positions, triangles, groups] : arrays) {
    sources.push_back({mesh_of(positions, triangles), values_of(groups)});
  }
  return sources;
}

// Returns make(cells, box, options) for an octree and its source meshes.
template <typename Make>
auto contoured(const Octree& octree, const std::vector<SourceArrays>& source_arrays,
               ContourOptions options, const py::object& progress, const Make& make) {
  options.run = to_run(progress, options.run.threads());
  const std::vector<SourceMesh> sources = sources_of(source_arrays);
  options.sources = sources;
  options.thickened = &octree.thickened;
  const py::gil_scoped_release unlocked;
  return make(octree.cells, octree.bounds, options);
}

MeshArrays bound_contour_octree(const Octree& octree,
                                const std::vector<SourceArrays>& source_arrays,
                                const ContourOptions& options, const py::object& progress) {
  return mesh_arrays(contoured(octree, source_arrays, options, progress, contour_occupancies));
}

using TracedArrays = std::tuple<Array<double>, Array<std::int32_t>, Array<std::int64_t>>;

TracedArrays bound_traced_contour(const Octree& octree,
                                  const std::vector<SourceArrays>& source_arrays,
                                  const ContourOptions& options, const py::object& progress) {
  TracedMesh traced = contoured(octree, source_arrays, options, progress, contour_traced);
  const auto count = static_cast<py::ssize_t>(traced.origins.size());
  auto [positions, triangles] = mesh_arrays(std::move(traced.mesh));
  return {std::move(positions), std::move(triangles),
          to_array<std::int64_t>(std::move(traced.origins), {count})};
}

TracedArrays bound_contour_quads(const Octree& octree,
                                 const std::vector<SourceArrays>& source_arrays,
                                 const ContourOptions& options, const py::object& progress) {
  QuadMesh mesh = contoured(octree, source_arrays, options, progress, contour_quads);
  const auto vertices = static_cast<py::ssize_t>(mesh.positions.size());
  const auto quads = static_cast<py::ssize_t>(mesh.quads.size());
  const auto origins = static_cast<py::ssize_t>(mesh.origins.size());
  return {to_array<double>(std::move(mesh.positions), {vertices, 3}),
          to_array<std::int32_t>(std::move(mesh.quads), {quads, 4}),
          to_array<std::int64_t>(std::move(mesh.origins), {origins})};
}

// Numbers of samples along the axes of a grid.
template <std::size_t N>
std::array<int, N> sides_of(const Array<float>& grid) {
  std::array<int, N> sides;
  for (std::size_t a = 0; a < N; ++a) {
    sides[a] =
        static_cast<int>(std::min<py::ssize_t>(grid.shape(static_cast<py::ssize_t>(a)), 1 << 30));
  }
  return sides;
}

MeshArrays bound_contour_grid(const Array<float>& grid, const Vector3& spacing,
                              const Vector3& origin, ContourOptions options,
                              const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const GridView view{grid.data(), sides_of<3>(grid)};
  TriangleMesh mesh;
  {
    const py::gil_scoped_release unlocked;
    mesh = contour_grid(view, {origin, spacing}, options);
  }
  return mesh_arrays(std::move(mesh));
}

using Pair = std::array<double, 2>;

std::vector<Array<double>> bound_contour_outlines(const Array<float>& grid, const Pair& spacing,
                                                  const Pair& origin, ContourOptions options,
                                                  const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const PlaneView view{grid.data(), sides_of<2>(grid)};
  std::vector<OutlinePoints> outlines;
  {
    const py::gil_scoped_release unlocked;
    outlines = contour_outlines(view, {origin, spacing}, options);
  }
  std::vector<Array<double>> arrays;
  for (OutlinePoints& outline : outlines) {
    const auto points = static_cast<py::ssize_t>(outline.size());
    arrays.push_back(to_array<double>(std::move(outline), {points, 2}));
  }
  return arrays;
}

}  // namespace

void bind_contour(py::module_& m) {
  bind_contour_options(m);
  m.def("contour_grid", &bound_contour_grid, py::arg("grid"), py::arg("spacing"), py::arg("origin"),
        py::arg("options"), py::arg("progress"));
  m.def("contour_outlines", &bound_contour_outlines, py::arg("grid"), py::arg("spacing"),
        py::arg("origin"), py::arg("options"), py::arg("progress"));
  m.def("traced_contour", &bound_traced_contour, py::arg("octree"), py::arg("sources"),
        py::arg("options"), py::arg("progress"));
  m.def("contour_quads", &bound_contour_quads, py::arg("octree"), py::arg("sources"),
        py::arg("options"), py::arg("progress"));
  m.def("contour_octree", &bound_contour_octree, py::arg("octree"), py::arg("sources"),
        py::arg("options"), py::arg("progress"));
}

}  // namespace prefilter::python
