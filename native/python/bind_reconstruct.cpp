// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "bind_options.h"
#include "convert.h"
#include "instances.h"
#include "prefilter/base/error.h"
#include "prefilter/base/names.h"
#include "prefilter/points/array_sink.h"
#include "prefilter/points/array_source.h"
#include "prefilter/points/joined_points.h"
#include "prefilter/points/phantoms.h"
#include "prefilter/points/ply_mesh_writer.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/points/steps.h"
#include "prefilter/points/turned_points.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

using Level = std::variant<double, std::string>;

void set_isovalue(ReconstructOptions* options, const Level& level) {
  if (const auto* name = std::get_if<std::string>(&level)) {
    if (*name != "auto" && *name != "mean" && *name != "half") {
      throw_invalid("isovalue: '" + *name + "' is not one of auto, mean, half, or a number");
    }
    options->isovalue = *name == "half" ? Isovalue::kHalf : Isovalue::kMean;
  } else {
    options->isovalue = Isovalue::kGiven;
    options->given_isovalue = std::get<double>(level);
  }
}

void bind_reconstruct_options(py::module_& m) {
  using Options = ReconstructOptions;
  auto bound = bind_options<Options>(m, "ReconstructOptions");
  bind_named(bound, "wavelet", &Options::basis, kWaveletBases);
  bound.def_readwrite("depth", &Options::depth)
      .def_readwrite("cell_size", &Options::cell_size)
      .def_readwrite("smooth", &Options::smooth)
      .def_property("isovalue", nullptr, &set_isovalue)
      .def_readwrite("are_sides_known", &Options::are_sides_known)
      .def_readwrite("check_normals", &Options::check_normals)
      .def_readwrite("fit", &Options::fit)
      .def_readwrite("watertight", &Options::watertight)
      .def_readwrite("trim", &Options::trim)
      .def_readwrite("adaptivity", &Options::adaptivity)
      .def_readwrite("support", &Options::support)
      .def_readwrite("memory_limit", &Options::memory_limit)
      .def_readwrite("folder", &Options::folder);
}

using Rows = std::variant<Array<float>, Array<double>>;

VectorRows rows_in(const Rows& arrays) {
  return std::visit([](const auto& array) -> VectorRows { return rows_of(array); }, arrays);
}

std::unique_ptr<ArraySource> array_points(const Rows& positions, const Rows& normals,
                                          const std::optional<Array<float>>& weights,
                                          const std::optional<Array<float>>& attributes,
                                          const std::vector<std::pair<std::string, bool>>& names,
                                          bool is_double) {
  const auto floats = [](const std::optional<Array<float>>& array) {
    return array ? std::span(array->data(), static_cast<std::size_t>(array->size()))
                 : std::span<const float>();
  };
  std::vector<PointAttribute> carried;
  for (const auto& [name, is_byte] : names) carried.push_back({name, is_byte});
  return std::make_unique<ArraySource>(rows_in(positions), rows_in(normals), floats(weights),
                                       floats(attributes), std::move(carried), is_double);
}

py::list to_list(const std::vector<PhantomPlace>& phantoms) {
  py::list result;
  for (const PhantomPlace& each : phantoms) {
    const auto& [x, y, z] = each.position;
    result.append(py::make_tuple(py::make_tuple(x, y, z), each.points));
  }
  return result;
}

py::list bound_find_phantoms(const Array<double>& points, const py::object& callback, int threads) {
  const Run run = to_run(callback, threads);
  std::vector<PhantomPlace> phantoms;
  {
    const py::gil_scoped_release unlocked;
    // Normals are not used here.
    ArraySource source(rows_of(points), rows_of(points), {}, {}, {}, true);
    phantoms = find_phantoms(&source, run);
  }
  return to_list(phantoms);
}

py::dict to_dict(const ReconstructReport& report) {
  py::dict result;
  result["points"] = report.points;
  result["dropped"] = report.dropped.sum();
  py::dict causes;
  causes["not_finite"] = report.dropped.not_finite;
  causes["huge"] = report.dropped.huge;
  causes["weightless"] = report.dropped.weightless;
  causes["normalless"] = report.dropped.normalless;
  result["causes"] = causes;
  result["phantoms"] = to_list(report.phantoms);
  constexpr const char* kFaults[] = {"", "missing", "contradictory"};
  result["normal_fault"] = kFaults[static_cast<std::size_t>(report.normal_fault)];
  result["contradiction"] = report.contradiction;
  result["strays"] = report.strays;
  result["outliers"] = report.outliers;
  result["vertices"] = report.vertices;
  result["triangles"] = report.triangles;
  result["is_flipped"] = report.is_flipped;
  result["is_room"] = report.is_room;
  result["residual"] = report.residual;
  result["depth"] = report.depth;
  result["cell"] = report.cell;
  result["float_step"] = report.float_step;
  result["is_spilled"] = report.is_spilled;
  result["cut"] = report.trimmed.cut;
  result["islands"] = report.trimmed.islands;
  result["island_share"] = report.trimmed.island;
  return result;
}

std::tuple<Array<double>, Array<std::int32_t>, Array<float>, py::dict> bound_reconstruct(
    PointSource* source, ReconstructOptions options, const py::object& callback) {
  options.run = to_run(callback, options.run.threads());
  ArraySink sink;
  ReconstructReport report;
  {
    const py::gil_scoped_release unlocked;
    report = reconstruct(source, options, &sink);
  }
  const auto vertices = static_cast<py::ssize_t>(report.vertices);
  const auto triangles = static_cast<py::ssize_t>(report.triangles);
  std::size_t columns = source->attributes().size();
  if (options.support) columns += support_attributes().size();
  const auto width = static_cast<py::ssize_t>(columns);
  return {to_array<double>(sink.take_positions(), {vertices, 3}),
          to_array<std::int32_t>(sink.take_triangles(), {triangles, 3}),
          to_array<float>(sink.take_attributes(), {vertices, width}), to_dict(report)};
}

// The mesh, its attributes, and the report of the cut.
std::tuple<Array<double>, Array<std::int32_t>, Array<float>, py::dict> bound_trim(
    const Array<double>& positions, const Array<std::int32_t>& triangles,
    const Array<float>& attributes, double distance, double hole, double island,
    const py::object& callback) {
  const Run run = to_run(callback);
  const auto columns = attributes.shape(1);
  const auto values = std::span(attributes.data(), static_cast<std::size_t>(attributes.size()));
  TrimmedMesh mesh;
  TrimReport report;
  {
    const py::gil_scoped_release unlocked;
    report = trim_surface(rows_of(positions), rows_of(triangles), values,
                          static_cast<std::size_t>(columns), {distance, hole, island}, run, &mesh);
  }
  py::dict cut_report;
  cut_report["cut"] = report.cut;
  cut_report["islands"] = report.islands;
  cut_report["island_share"] = report.island;
  const auto vertices = static_cast<py::ssize_t>(mesh.positions.size());
  const auto faces = static_cast<py::ssize_t>(mesh.triangles.size());
  return {to_array<double>(std::move(mesh.positions), {vertices, 3}),
          to_array<std::int32_t>(std::move(mesh.triangles), {faces, 3}),
          to_array<float>(std::move(mesh.attributes), {vertices, columns}), cut_report};
}

// Creates the file that a surface of the source is written to.
std::unique_ptr<PlyMeshWriter> mesh_writer(const PointSource& source, const std::string& target,
                                           const ReconstructOptions& options) {
  std::vector<PointAttribute> attributes = source.attributes();
  if (options.support) {
    for (PointAttribute& each : support_attributes()) attributes.push_back(std::move(each));
  }
  return std::make_unique<PlyMeshWriter>(target, std::move(attributes), source.is_double());
}

py::dict bound_reconstruct_file(PointSource* source, const std::string& target,
                                ReconstructOptions options, const py::object& callback) {
  const Run run = to_run(callback, options.run.threads());
  ReconstructReport report;
  {
    const py::gil_scoped_release unlocked;
    const std::unique_ptr<PlyMeshWriter> writer = mesh_writer(*source, target, options);
    options.run = run.part(0.0, 0.95);
    report = reconstruct(source, options, writer.get());
    if (report.normal_fault == NormalFault::kNone) writer->finish(run.part(0.95, 1.0));
  }
  return to_dict(report);
}

// Runs a step that writes a file from one source, from all counts, or from all cells.
void bound_step(const std::string& step, PointSource* source, std::size_t number,
                const StepFiles& files, ReconstructOptions options, const py::object& callback) {
  options.run = to_run(callback, options.run.threads());
  const py::gil_scoped_release unlocked;
  if (step == "measure") measure_step(source, number, files, options);
  if (step == "count") count_step(source, number, files, options);
  if (step == "merge") merge_step(files, options);
  if (step == "part") part_step(number, source->attributes().size(), files, options);
}

py::dict bound_join(PointSource* source, const StepFiles& files, const std::string& target,
                    ReconstructOptions options, const py::object& callback) {
  const Run run = to_run(callback, options.run.threads());
  ReconstructReport report;
  {
    const py::gil_scoped_release unlocked;
    const std::unique_ptr<PlyMeshWriter> writer = mesh_writer(*source, target, options);
    options.run = run.part(0.0, 0.95);
    report = join_step(source->attributes().size(), files, options, writer.get());
    writer->finish(run.part(0.95, 1.0));
  }
  return to_dict(report);
}

void bind_steps(py::module_& m) {
  py::class_<StepFiles>(m, "StepFiles")
      .def(py::init([](std::string work, std::vector<std::string> measures,
                       std::vector<std::string> counts, std::string cells,
                       std::vector<std::string> parts) {
             return StepFiles{std::move(work), std::move(measures), std::move(counts),
                              std::move(cells), std::move(parts)};
           }),
           py::arg("work"), py::arg("measures"), py::arg("counts"), py::arg("cells"),
           py::arg("parts"));
  m.def("reconstruct_step", &bound_step, py::arg("step"), py::arg("source"), py::arg("number"),
        py::arg("files"), py::arg("options"), py::arg("progress"));
  m.def("join_steps", &bound_join, py::arg("source"), py::arg("files"), py::arg("target"),
        py::arg("options"), py::arg("progress"));
}

}  // namespace

void bind_reconstruct(py::module_& m) {
  bind_reconstruct_options(m);
  // Keeps the arrays alive.
  py::class_<ArraySource, PointSource>(m, "ArrayPoints")
      .def(py::init(&array_points), py::arg("positions"), py::arg("normals"), py::arg("weights"),
           py::arg("attributes"), py::arg("names"), py::arg("is_double"), py::keep_alive<1, 2>(),
           py::keep_alive<1, 3>(), py::keep_alive<1, 4>(), py::keep_alive<1, 5>());
  // Keeps the sources alive.
  py::class_<JoinedPoints, PointSource>(m, "JoinedPoints")
      .def(py::init([](const py::tuple& sources, std::size_t rows_a_share) {
             return std::make_unique<JoinedPoints>(sources.cast<std::vector<PointSource*>>(),
                                                   rows_a_share);
           }),
           py::arg("sources"), py::arg("rows_a_share") = JoinedPoints::kAllRows,
           py::keep_alive<1, 2>())
      .def_property_readonly("share_count", &JoinedPoints::share_count)
      .def("choose_share", &JoinedPoints::choose_share, py::arg("share"));
  py::class_<TurnedPoints, PointSource>(m, "TurnedPoints")
      .def(py::init([](PointSource* source, bool is_up, const Array<double>& viewpoints) {
             const std::span<const Vector3> rows = rows_of(viewpoints);
             return std::make_unique<TurnedPoints>(
                 source, is_up ? TurnedPoints::Side::kUp : TurnedPoints::Side::kViewpoint,
                 std::vector<Vector3>(rows.begin(), rows.end()));
           }),
           py::arg("source"), py::arg("is_up"), py::arg("viewpoints"), py::keep_alive<1, 2>());
  m.def("reconstruct", &bound_reconstruct, py::arg("source"), py::arg("options"),
        py::arg("progress"));
  m.def("find_phantoms", &bound_find_phantoms, py::arg("points"), py::arg("progress"),
        py::arg("threads"));
  m.def("trim", &bound_trim, py::arg("positions"), py::arg("triangles"), py::arg("attributes"),
        py::arg("distance"), py::arg("hole"), py::arg("island"), py::arg("progress"));
  m.def("reconstruct_file", &bound_reconstruct_file, py::arg("source"), py::arg("target"),
        py::arg("options"), py::arg("progress"));
  bind_steps(m);
}

}  // namespace prefilter::python
