// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "convert.h"
#include "instances.h"
#include "prefilter/base/memory.h"
#include "prefilter/points/chosen_points.h"
#include "prefilter/points/completed_normals.h"
#include "prefilter/points/directed_normals.h"
#include "prefilter/points/face_normals.h"
#include "prefilter/points/float_steps.h"
#include "prefilter/points/height_field.h"
#include "prefilter/points/moved_points.h"
#include "prefilter/points/normals.h"
#include "prefilter/points/open_points.h"
#include "prefilter/points/origin_role.h"
#include "prefilter/points/ply_faces.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/unpacked_file.h"
#include "python_points.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

constexpr std::size_t kPointsAtOnce = 1 << 16;

// The values of one attribute.
struct AttributeValues {
  std::vector<float> floats;
  std::vector<std::uint8_t> bytes;  // used instead for an attribute of bytes
};

struct AllPoints {
  std::vector<Vector3> positions;
  std::vector<std::array<float, 3>> normals;
  std::vector<float> weights;
  std::vector<Vector3> viewpoints;
  std::vector<AttributeValues> attributes;
  std::size_t stride = 1;  // number of source points per point
};

// Names in files may contain any bytes.
py::str to_str(const std::string& text) {
  PyObject* const decoded =
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "backslashreplace");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

std::uint8_t to_byte(float value) {
  return value >= 0.0F ? static_cast<std::uint8_t>(std::lround(std::min(value, 255.0F))) : 0;
}

// Number of points if only every stride-th is kept.
std::size_t thinned_count(std::size_t count, std::size_t stride) {
  return (count + stride - 1) / stride;
}

void check_room(const PointSource& source, std::size_t stride) {
  if (!source.count()) return;
  std::size_t bytes = sizeof(Vector3) + sizeof(float);
  if (source.has_normals()) bytes += sizeof(std::array<float, 3>);
  for (const PointAttribute& each : source.attributes()) {
    bytes += each.is_byte ? sizeof(std::uint8_t) : sizeof(float);
  }
  const std::size_t count = thinned_count(*source.count(), stride);
  check_memory("a cloud of " + std::to_string(count) + " points",
               static_cast<double>(bytes) * static_cast<double>(count));
}

template <typename T>
void append(const std::vector<T>& more, std::vector<T>* all) {
  all->insert(all->end(), more.begin(), more.end());
}

// Keeps every stride-th group of `width` values, starting with group `first`.
template <typename T>
void thin(std::size_t first, std::size_t stride, std::size_t width, std::vector<T>* values) {
  std::size_t kept = 0;
  for (std::size_t i = first * width; i + width <= values->size() && width > 0;
       i += stride * width) {
    for (std::size_t k = 0; k < width; ++k) (*values)[kept++] = (*values)[i + k];
  }
  values->resize(kept);
}

void thin_batch(std::size_t first, std::size_t stride, std::size_t width, PointBatch* batch) {
  thin(first, stride, 1, &batch->positions);
  thin(first, stride, 1, &batch->normals);
  thin(first, stride, 1, &batch->weights);
  thin(first, stride, 1, &batch->viewpoints);
  thin(first, stride, width, &batch->attributes);
}

void halve(AllPoints* all) {
  thin(0, 2, 1, &all->positions);
  thin(0, 2, 1, &all->normals);
  thin(0, 2, 1, &all->weights);
  thin(0, 2, 1, &all->viewpoints);
  for (AttributeValues& each : all->attributes) {
    thin(0, 2, 1, &each.floats);
    thin(0, 2, 1, &each.bytes);
  }
}

void append_attributes(const PointBatch& batch, const std::vector<PointAttribute>& attributes,
                       AllPoints* all) {
  for (std::size_t a = 0; a < attributes.size(); ++a) {
    for (std::size_t i = a; i < batch.attributes.size(); i += attributes.size()) {
      if (attributes[a].is_byte) {
        all->attributes[a].bytes.push_back(to_byte(batch.attributes[i]));
      } else {
        all->attributes[a].floats.push_back(batch.attributes[i]);
      }
    }
  }
}

// Reads the points 0, stride, 2 * stride and so on. The stride is the smallest that leaves at most
// `most` points, or a power of two if their number is unknown.
AllPoints read_all(PointSource* source, std::size_t most, const Run& run) {
  const std::vector<PointAttribute>& attributes = source->attributes();
  AllPoints all;
  if (source->count()) all.stride = std::max<std::size_t>(thinned_count(*source->count(), most), 1);
  check_room(*source, all.stride);
  all.attributes.resize(attributes.size());
  if (source->count()) all.positions.reserve(thinned_count(*source->count(), all.stride));
  source->rewind();
  PointBatch batch;
  std::size_t seen = 0;
  while (source->read(kPointsAtOnce, &batch)) {
    const std::size_t first = (all.stride - seen % all.stride) % all.stride;
    seen += batch.positions.size();
    if (all.stride > 1) thin_batch(first, all.stride, attributes.size(), &batch);
    append(batch.positions, &all.positions);
    append(batch.normals, &all.normals);
    append(batch.weights, &all.weights);
    append(batch.viewpoints, &all.viewpoints);
    append_attributes(batch, attributes, &all);
    while (all.positions.size() > most) {
      halve(&all);
      all.stride *= 2;
    }
    if (source->count()) {
      run.report(static_cast<double>(seen) / static_cast<double>(*source->count()));
    } else {
      run.report(0.0);
    }
  }
  run.report(1.0);
  return all;
}

py::tuple bound_read_points(PointSource* source, std::size_t most, const py::object& callback) {
  const Run run = to_run(callback);
  AllPoints all;
  {
    const py::gil_scoped_release unlocked;
    all = read_all(source, most, run);
  }
  const auto count = static_cast<py::ssize_t>(all.positions.size());
  py::object normals = py::none();
  py::object weights = py::none();
  if (source->has_normals()) normals = to_array<float>(std::move(all.normals), {count, 3});
  if (!all.weights.empty()) weights = to_array<float>(std::move(all.weights), {count});
  py::object viewpoints = py::none();
  if (!all.viewpoints.empty()) viewpoints = to_array<double>(std::move(all.viewpoints), {count, 3});
  py::dict attributes;
  for (std::size_t a = 0; a < all.attributes.size(); ++a) {
    const PointAttribute& attribute = source->attributes()[a];
    AttributeValues& values = all.attributes[a];
    if (attribute.is_byte) {
      attributes[to_str(attribute.name)] = to_array<std::uint8_t>(std::move(values.bytes), {count});
    } else {
      attributes[to_str(attribute.name)] = to_array<float>(std::move(values.floats), {count});
    }
  }
  return py::make_tuple(to_array<double>(std::move(all.positions), {count, 3}), normals, weights,
                        viewpoints, attributes, all.stride);
}

// `File` is a path or a decompressed file.
template <typename File>
py::object bound_read_range_grid(const File& file, const py::object& callback) {
  const Run run = to_run(callback);
  std::optional<RangeGrid> grid;
  {
    const py::gil_scoped_release unlocked;
    grid = read_range_grid(file, run);
  }
  if (!grid) return py::none();
  return to_array<std::int64_t>(std::move(grid->points), {grid->rows, grid->columns});
}

py::tuple bound_read_ply_mesh(const std::string& path, const py::object& callback) {
  const Run run = to_run(callback);
  PlyMesh mesh;
  {
    const py::gil_scoped_release unlocked;
    mesh = read_ply_mesh(path, run);
  }
  const auto rows = [](const auto& vector) { return static_cast<py::ssize_t>(vector.size()); };
  const py::ssize_t counts[] = {rows(mesh.positions), rows(mesh.sizes), rows(mesh.corners)};
  const bool has_uvs = !mesh.uvs.empty();
  const py::ssize_t uv_count = rows(mesh.uvs);
  return py::make_tuple(
      to_array<double>(std::move(mesh.positions), {counts[0], 3}),
      to_array<std::int64_t>(std::move(mesh.corners), {counts[2]}),
      to_array<std::int64_t>(std::move(mesh.sizes), {counts[1]}),
      has_uvs ? py::object(to_array<double>(std::move(mesh.uvs), {uv_count, 2})) : py::none());
}

template <typename File>
Array<std::int64_t> bound_read_faces(const File& file, const py::object& callback) {
  const Run run = to_run(callback);
  std::vector<std::array<std::int64_t, 3>> triangles;
  {
    const py::gil_scoped_release unlocked;
    triangles = read_faces(file, run);
  }
  const auto count = static_cast<py::ssize_t>(triangles.size());
  return to_array<std::int64_t>(std::move(triangles), {count, 3});
}

Array<double> bound_estimate_normals(const Array<double>& points, int neighbours,
                                     const Array<double>& viewpoints, const std::string& direction,
                                     const py::object& callback, int threads) {
  const Run run = to_run(callback, threads);
  const NormalSide side = value_named("direction", direction, kNormalSides);
  std::vector<Vector3> normals;
  {
    const py::gil_scoped_release unlocked;
    normals = estimate_normals(rows_of(points), neighbours, rows_of(viewpoints), side, run);
  }
  return to_array<double>(std::move(normals), {points.shape(0), 3});
}

Array<double> bound_directed_normals(const Array<double>& points, const Array<double>& normals,
                                     const py::object& callback, int threads) {
  const Run run = to_run(callback, threads);
  std::vector<Vector3> directed;
  {
    const py::gil_scoped_release unlocked;
    directed = directed_normals(rows_of(points), rows_of(normals), run);
  }
  return to_array<double>(std::move(directed), {points.shape(0), 3});
}

Array<double> bound_completed_normals(const Array<double>& points, const Array<double>& normals,
                                      int neighbours, const py::object& callback, int threads) {
  const Run run = to_run(callback, threads);
  std::vector<Vector3> completed;
  {
    const py::gil_scoped_release unlocked;
    completed = completed_normals(rows_of(points), rows_of(normals), neighbours, run);
  }
  return to_array<double>(std::move(completed), {points.shape(0), 3});
}

std::string bound_origin_role(const Array<double>& points, const py::object& callback,
                              int threads) {
  const Run run = to_run(callback, threads);
  const py::gil_scoped_release unlocked;
  const OriginRole role = origin_role(rows_of(points), run);
  for (const auto& each : kOriginRoles) {
    if (each.value == role) return std::string(each.name);
  }
  return "";
}

Array<double> bound_mesh_normals(const py::array& points, const py::array& triangles,
                                 const py::object& callback) {
  const Run run = to_run(callback);
  const InputMesh mesh = mesh_of(points, triangles);
  std::vector<Vector3> normals;
  {
    const py::gil_scoped_release unlocked;
    normals = mesh_normals(mesh, run);
  }
  return to_array<double>(std::move(normals), {points.shape(0), 3});
}

py::tuple bound_grid_normals(const Array<double>& points, const Array<std::int64_t>& grid,
                             const std::optional<Vector3>& viewpoint, const py::object& callback) {
  const Run run = to_run(callback);
  GridNormals normals;
  {
    const py::gil_scoped_release unlocked;
    const RangeGrid range_grid = {
        grid.shape(0), grid.shape(1), {grid.data(), grid.data() + grid.size()}};
    normals = grid_normals(rows_of(points), range_grid, viewpoint, run);
  }
  return py::make_tuple(to_array<double>(std::move(normals.normals), {points.shape(0), 3}),
                        to_array<float>(std::move(normals.weights), {points.shape(0)}));
}

std::unique_ptr<ChosenPoints> chosen_points(PointSource* source,
                                            const std::optional<std::pair<Vector3, Vector3>>& box,
                                            const std::optional<std::vector<std::uint8_t>>& classes,
                                            const std::string& returns, const std::string& name) {
  PointChoice choice;
  if (box) choice.box = Box{box->first, box->second};
  if (classes) {
    choice.classes.emplace();
    for (const std::uint8_t each : *classes) choice.classes->set(each);
  }
  choice.returns = value_named("returns", returns, kReturnsNames);
  return std::make_unique<ChosenPoints>(source, choice, name);
}

}  // namespace

void bind_scan(py::module_& m) {
  py::class_<PointSource>(m, "PointSource")
      .def(py::init(&make_python_points), py::arg("reader"))
      .def_property_readonly("count", &PointSource::count)
      .def_property_readonly("has_normals", &PointSource::has_normals)
      .def_property_readonly("are_normals_directed", &PointSource::are_normals_directed)
      .def_property_readonly("is_double", &PointSource::is_double)
      .def_property_readonly("attributes",
                             [](const PointSource& source) {
                               std::vector<std::pair<py::str, bool>> attributes;
                               for (const PointAttribute& each : source.attributes()) {
                                 attributes.emplace_back(to_str(each.name), each.is_byte);
                               }
                               return attributes;
                             })
      .def_property_readonly("warnings",
                             [](const PointSource& source) {
                               py::list warnings;
                               for (const std::string& each : source.warnings()) {
                                 warnings.append(to_str(each));
                               }
                               return warnings;
                             })
      .def_property_readonly("viewpoint", [](const PointSource& source) -> py::object {
        const std::optional<Vector3> viewpoint = source.viewpoint();
        if (!viewpoint) return py::none();
        return py::make_tuple((*viewpoint)[0], (*viewpoint)[1], (*viewpoint)[2]);
      });
  // Keeps the sources alive.
  py::class_<ChosenPoints, PointSource>(m, "ChosenPoints")
      .def(py::init(&chosen_points), py::arg("source"), py::arg("box"), py::arg("classes"),
           py::arg("returns"), py::arg("name"), py::keep_alive<1, 2>());
  py::class_<MovedPoints, PointSource>(m, "MovedPoints")
      .def(py::init([](PointSource* source, const Array<double>& matrix) {
             return std::make_unique<MovedPoints>(source, motion_of(matrix));
           }),
           py::arg("source"), py::arg("matrix"), py::keep_alive<1, 2>());
  m.def(
      "moved",
      [](const Array<double>& points, const Array<double>& matrix) {
        const RigidMotion motion = motion_of(matrix);
        std::vector<Vector3> moved_points;
        for (const Vector3& point : rows_of(points)) moved_points.push_back(moved(motion, point));
        return to_array<double>(std::move(moved_points), {points.shape(0), 3});
      },
      py::arg("points"), py::arg("matrix"));
  m.attr("RETURNS") = names_of(kReturnsNames);
  py::class_<UnpackedFile>(m, "UnpackedFile")
      .def(py::init<const std::string&>(), py::arg("packed"))
      .def(
          "write",
          [](UnpackedFile* file, const py::bytes& bytes) {
            const auto text = static_cast<std::string_view>(bytes);
            const py::gil_scoped_release unlocked;
            file->write(std::as_bytes(std::span(text)));
          },
          py::arg("bytes"));
  m.attr("POINT_EXTENSIONS") = py::tuple(py::cast(point_extensions()));
  m.def("open_points", &open_points, py::arg("path"), py::call_guard<py::gil_scoped_release>());
  m.def("open_ply", &open_ply, py::arg("file"), py::call_guard<py::gil_scoped_release>());
  m.def("read_range_grid", &bound_read_range_grid<std::string>, py::arg("path"),
        py::arg("progress"));
  m.def("read_range_grid", &bound_read_range_grid<UnpackedFile>, py::arg("file"),
        py::arg("progress"));
  m.def("read_ply_mesh", &bound_read_ply_mesh, py::arg("path"), py::arg("progress"));
  m.def("read_faces", &bound_read_faces<std::string>, py::arg("path"), py::arg("progress"));
  m.def("read_faces", &bound_read_faces<UnpackedFile>, py::arg("file"), py::arg("progress"));
  m.def("read_points", &bound_read_points, py::arg("source"), py::arg("most"), py::arg("progress"));
  m.def("mesh_normals", &bound_mesh_normals, py::arg("points"), py::arg("triangles"),
        py::arg("progress"));
  m.def("grid_normals", &bound_grid_normals, py::arg("points"), py::arg("grid"),
        py::arg("viewpoint"), py::arg("progress"));
  m.def("completed_normals", &bound_completed_normals, py::arg("points"), py::arg("normals"),
        py::arg("neighbours"), py::arg("progress"), py::arg("threads"));
  m.def("origin_role", &bound_origin_role, py::arg("points"), py::arg("progress"),
        py::arg("threads"));
  m.def("directed_normals", &bound_directed_normals, py::arg("points"), py::arg("normals"),
        py::arg("progress"), py::arg("threads"));
  m.def("estimate_normals", &bound_estimate_normals, py::arg("points"), py::arg("neighbours"),
        py::arg("viewpoints"), py::arg("direction"), py::arg("progress"), py::arg("threads"));
  m.def(
      "float_step",
      [](const Array<double>& points) {
        const py::gil_scoped_release unlocked;
        FloatSteps steps;
        for (const Vector3& point : rows_of(points)) steps.add(point);
        return steps.step();
      },
      py::arg("points"));
  m.def(
      "is_height_field",
      [](const Array<double>& points, const py::object& callback) {
        const Run run = to_run(callback);
        const py::gil_scoped_release unlocked;
        return is_height_field(rows_of(points), run);
      },
      py::arg("points"), py::arg("progress"));
}

}  // namespace prefilter::python
