#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "convert.h"
#include "instances.h"
#include "prefilter/base/error.h"
#include "prefilter/contour/grid_contour.h"
#include "prefilter/contour/tree_contour.h"
#include "prefilter/voxel/octree.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

Interpolant interpolant_of(const std::string& name) {
  if (name == "occupancy") return Interpolant::kOccupancy;
  if (name == "plane") return Interpolant::kPlane;
  if (name == "linear") return Interpolant::kLinear;
  throw_invalid("interpolant: '" + name + "' is not one of occupancy, plane, linear");
}

ContourOptions contour_options(const std::string& interpolant, float isovalue, bool clean_up,
                               const py::object& progress, int threads) {
  ContourOptions options;
  options.interpolant = interpolant_of(interpolant);
  options.isovalue = isovalue;
  options.clean_up = clean_up;
  options.threads = threads;
  options.progress = to_progress(progress);
  return options;
}

// An array of the rows, which it owns.
template <typename T>
Array<T> to_rows(std::vector<std::array<T, 3>> rows) {
  auto owner = std::make_unique<std::vector<std::array<T, 3>>>(std::move(rows));
  const auto& held = *owner;
  const py::capsule capsule(owner.release(), [](void* pointer) {
    delete static_cast<std::vector<std::array<T, 3>>*>(pointer);
  });
  const auto count = static_cast<py::ssize_t>(held.size());
  return Array<T>({count, py::ssize_t{3}}, reinterpret_cast<const T*>(held.data()), capsule);
}

using MeshArrays = std::pair<Array<float>, Array<std::int32_t>>;

MeshArrays to_arrays(TriangleMesh mesh) {
  return {to_rows(std::move(mesh.positions)), to_rows(std::move(mesh.triangles))};
}

MeshArrays bound_contour_octree(const Octree& octree, const std::string& interpolant,
                                float isovalue, bool clean_up, const py::object& progress,
                                int threads) {
  const ContourOptions options =
      contour_options(interpolant, isovalue, clean_up, progress, threads);
  const Box& box = octree.bounds;
  const RootFrame frame{box.low, {box.size(0), box.size(1), box.size(2)}};
  TriangleMesh mesh;
  {
    const py::gil_scoped_release unlocked;
    mesh = contour_tree(octree.cells, frame, options);
  }
  return to_arrays(std::move(mesh));
}

GridView grid_view(const Array<float>& grid) {
  GridView view;
  view.values = grid.data();
  for (int a = 0; a < 3; ++a) {
    view.size[a] =
        a < grid.ndim() ? static_cast<int>(std::min<py::ssize_t>(grid.shape(a), 1 << 30)) : 1;
  }
  return view;
}

using Triple = std::array<double, 3>;

MeshArrays bound_contour_grid(const Array<float>& grid, const std::string& interpolant,
                              float isovalue, const Triple& spacing, const Triple& origin,
                              bool clean_up, const py::object& progress, int threads) {
  const ContourOptions options =
      contour_options(interpolant, isovalue, clean_up, progress, threads);
  const GridView view = grid_view(grid);
  TriangleMesh mesh;
  {
    const py::gil_scoped_release unlocked;
    mesh = contour_grid(view, {origin, spacing}, options);
  }
  return to_arrays(std::move(mesh));
}

std::vector<Array<float>> bound_contour_image(const Array<float>& image,
                                              const std::string& interpolant, float isovalue,
                                              const Triple& spacing, const Triple& origin,
                                              const py::object& progress) {
  const ContourOptions options = contour_options(interpolant, isovalue, false, progress, 1);
  const GridView view = grid_view(image);
  std::vector<Polyline> lines;
  {
    const py::gil_scoped_release unlocked;
    lines = contour_image(view, {origin, spacing}, options);
  }
  std::vector<Array<float>> arrays;
  for (const Polyline& line : lines) {
    Array<float> array({static_cast<py::ssize_t>(line.size()), py::ssize_t{2}});
    std::memcpy(array.mutable_data(), line.data(), line.size() * sizeof(line[0]));
    arrays.push_back(std::move(array));
  }
  return arrays;
}

}  // namespace

void bind_contour(py::module_& m) {
  m.def("contour_grid", &bound_contour_grid, py::arg("grid"), py::arg("interpolant"),
        py::arg("isovalue"), py::arg("spacing"), py::arg("origin"), py::arg("clean_up"),
        py::arg("progress"), py::arg("threads"));
  m.def("contour_image", &bound_contour_image, py::arg("image"), py::arg("interpolant"),
        py::arg("isovalue"), py::arg("spacing"), py::arg("origin"), py::arg("progress"));
  m.def("contour_octree", &bound_contour_octree, py::arg("octree"), py::arg("interpolant"),
        py::arg("isovalue"), py::arg("clean_up"), py::arg("progress"), py::arg("threads"));
}

}  // namespace prefilter::python
