// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "convert.h"
#include "instances.h"
#include "prefilter/base/error.h"
#include "prefilter/base/names.h"
#include "prefilter/voxels/combine.h"
#include "prefilter/voxels/octree.h"
#include "prefilter/voxels/queries.h"
#include "prefilter/voxels/voxelize.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

using Corners = std::pair<Vector3, Vector3>;

Box to_box(const Corners& corners) { return {corners.first, corners.second}; }

Octree bound_voxelize(const py::array& positions, const py::array& triangles, int depth,
                      const std::optional<Corners>& bounds, double thickness,
                      const py::object& progress, int threads) {
  VoxelizeOptions options;
  options.depth = depth;
  options.thickness = thickness;
  if (bounds) options.bounds = to_box(*bounds);
  options.run = to_run(progress, threads);
  const InputMesh mesh = mesh_of(positions, triangles);
  const py::gil_scoped_release unlocked;
  return voxelize(mesh, options);
}

Octree bound_combine(const Octree& a, const Octree& b, const std::string& name,
                     const py::object& callback, int threads) {
  const SetOperation operation = value_named("operation", name, kSetOperations);
  const Run progress = to_run(callback, threads);
  const py::gil_scoped_release unlocked;
  return combine(a, b, operation, progress);
}

Array<float> bound_dense(const Octree& octree, int depth, const py::object& callback, int threads) {
  const Run progress = to_run(callback, threads);
  std::vector<float> values;
  {
    const py::gil_scoped_release unlocked;
    values = dense_values(octree, depth, progress);
  }
  const py::ssize_t n = py::ssize_t{1} << depth;
  return to_array<float>(std::move(values), {n, n, n});
}

Array<float> bound_values(const Octree& octree, const Array<double>& points, int threads) {
  std::vector<float> values;
  {
    const py::gil_scoped_release unlocked;
    values = values_at(octree, rows_of(points), threads);
  }
  return to_array<float>(std::move(values), {points.shape(0)});
}

Array<std::int8_t> bound_classify(const Octree& octree, const Array<double>& points,
                                  double tolerance, int threads) {
  std::vector<std::int8_t> sides;
  {
    const py::gil_scoped_release unlocked;
    sides = classify(octree, rows_of(points), tolerance, threads);
  }
  return to_array<std::int8_t>(std::move(sides), {points.shape(0)});
}

// For each level, the blocks' values and the bit masks of split octants.
std::vector<std::pair<Array<float>, Array<std::uint8_t>>> bound_levels(const Octree& octree) {
  std::vector<std::pair<Array<float>, Array<std::uint8_t>>> levels;
  for (const TreeLevel& level : octree.cells.levels) {
    const auto count = static_cast<py::ssize_t>(level.size());
    Array<float> blocks({count, py::ssize_t{8}});
    std::memcpy(blocks.mutable_data(), level.blocks.data(), level.size() * sizeof(OctantValues));
    Array<std::uint8_t> split(count);
    std::memcpy(split.mutable_data(), level.split.data(), level.size());
    levels.emplace_back(std::move(blocks), std::move(split));
  }
  return levels;
}

Octree bound_make_octree(const std::vector<std::pair<Array<float>, Array<std::uint8_t>>>& arrays,
                         float root, const Corners& bounds, int depth) {
  std::vector<TreeLevel> levels(arrays.size());
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const auto& [blocks, split] = arrays[k];
    levels[k].blocks.resize(static_cast<std::size_t>(blocks.shape(0)));
    std::memcpy(levels[k].blocks.data(), blocks.data(),
                levels[k].blocks.size() * sizeof(OctantValues));
    levels[k].split.assign(split.data(), split.data() + split.shape(0));
  }
  const py::gil_scoped_release unlocked;
  return make_octree(std::move(levels), root, to_box(bounds), depth);
}

// Triangle indices, original and resulting thickness, and areas.
std::tuple<Array<std::int64_t>, Array<double>, Array<double>, Array<double>> bound_thin(
    const Octree& octree, bool only_walls) {
  const std::vector<ThinTriangle>& thin = only_walls ? octree.thin_walls : octree.thin;
  const auto count = static_cast<py::ssize_t>(thin.size());
  Array<std::int64_t> triangles(count);
  Array<double> thickness(count);
  Array<double> thickened(count);
  Array<double> areas(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    const ThinTriangle& triangle = thin[static_cast<std::size_t>(i)];
    triangles.mutable_at(i) = triangle.triangle;
    thickness.mutable_at(i) = triangle.thickness;
    thickened.mutable_at(i) = triangle.made;
    areas.mutable_at(i) = triangle.area;
  }
  return {std::move(triangles), std::move(thickness), std::move(thickened), std::move(areas)};
}

std::size_t byte_count(const Octree& octree) {
  std::size_t bytes = sizeof(Octree);
  for (const TreeLevel& level : octree.cells.levels) {
    bytes += level.size() * (sizeof(OctantValues) + sizeof(std::uint8_t) + sizeof(std::uint32_t));
  }
  return bytes;
}

}  // namespace

void bind_voxel(py::module_& m) {
  m.attr("MAX_DEPTH") = kMaxTreeDepth;
  py::class_<Octree, std::shared_ptr<Octree>>(m, "Octree")
      .def(py::init([](std::shared_ptr<Octree> shared) { return shared; }), py::arg("shared"))
      .def_property_readonly("volume", &volume)
      .def_property_readonly("root", [](const Octree& octree) { return octree.cells.root; })
      .def_property_readonly("depth", [](const Octree& octree) { return octree.depth; })
      .def_property_readonly("bounds",
                             [](const Octree& octree) {
                               return Corners{octree.bounds.low, octree.bounds.high};
                             })
      .def_property_readonly("node_count",
                             [](const Octree& octree) { return octree.cells.cell_count(); })
      .def_property_readonly("nbytes", &byte_count);
  m.def("dense_values", &bound_dense, py::arg("octree"), py::arg("depth"), py::arg("progress"),
        py::arg("threads"));
  m.def("values_at", &bound_values, py::arg("octree"), py::arg("points"), py::arg("threads"));
  m.def("classify", &bound_classify, py::arg("octree"), py::arg("points"), py::arg("tolerance"),
        py::arg("threads"));
  m.def(
      "box_occupancy",
      [](const Octree& octree, const Corners& box) { return box_occupancy(octree, to_box(box)); },
      py::arg("octree"), py::arg("box"));
  m.def("combine", &bound_combine, py::arg("octree"), py::arg("other"), py::arg("operation"),
        py::arg("progress"), py::arg("threads"));
  m.def("coarsened", &coarsened, py::arg("octree"), py::arg("depth"));
  m.def("levels_of", &bound_levels, py::arg("octree"));
  m.def("voxelize", &bound_voxelize, py::arg("positions"), py::arg("triangles"), py::arg("depth"),
        py::arg("bounds"), py::arg("thickness"), py::arg("progress"), py::arg("threads"));
  m.def(
      "cube_around",
      [](const Corners& box, int depth) {
        const Box cube = cube_around(to_box(box), depth);
        return Corners{cube.low, cube.high};
      },
      py::arg("box"), py::arg("depth"));
  m.def("thin_triangles", &bound_thin, py::arg("octree"), py::arg("only_walls"));
  m.def("make_octree", &bound_make_octree, py::arg("levels"), py::arg("root"), py::arg("bounds"),
        py::arg("depth"));
}

}  // namespace prefilter::python
