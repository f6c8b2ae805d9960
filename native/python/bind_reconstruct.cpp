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

#include "convert.h"
#include "instances.h"
#include "prefilter/base/error.h"
#include "prefilter/mesh/array_sink.h"
#include "prefilter/mesh/ply_mesh_writer.h"
#include "prefilter/reconstruct/reconstruct.h"
#include "prefilter/scan/array_source.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

WaveletBasis basis_of(const std::string& name) {
  if (name == "haar") return WaveletBasis::kHaar;
  if (name == "d4") return WaveletBasis::kD4;
  throw_invalid("wavelet: '" + name + "' is not one of haar, d4");
}

ReconstructOptions options_of(int depth, const std::string& wavelet, bool smooth,
                              const std::variant<double, std::string>& isovalue,
                              bool are_sides_known, bool fit, const std::optional<double>& trim,
                              const std::optional<std::uint64_t>& memory_limit,
                              const std::string& folder, const py::object& progress, int threads) {
  ReconstructOptions options;
  options.depth = depth;
  options.basis = basis_of(wavelet);
  options.smooth = smooth;
  if (const auto* name = std::get_if<std::string>(&isovalue)) {
    if (*name != "auto" && *name != "mean" && *name != "half") {
      throw_invalid("isovalue: '" + *name + "' is not one of auto, mean, half, or a number");
    }
    options.isovalue = *name == "half" ? Isovalue::kHalf : Isovalue::kMean;
  } else {
    options.isovalue = Isovalue::kGiven;
    options.given_isovalue = std::get<double>(isovalue);
  }
  options.are_sides_known = are_sides_known;
  options.fit = fit;
  options.trim = trim;
  if (memory_limit) options.memory_limit = *memory_limit;
  options.folder = folder;
  options.threads = threads;
  options.progress = to_progress(progress);
  return options;
}

using Rows = std::variant<Array<float>, Array<double>>;

VectorRows rows_in(const Rows& arrays) {
  return std::visit([](const auto& array) -> VectorRows { return rows_of(array); }, arrays);
}

std::unique_ptr<ArraySource> array_points(const Rows& positions, const Rows& normals,
                                          const std::optional<Array<float>>& weights,
                                          const std::optional<Array<float>>& attributes,
                                          const std::vector<std::pair<std::string, bool>>& names) {
  const auto floats = [](const std::optional<Array<float>>& array) {
    return array ? std::span(array->data(), static_cast<std::size_t>(array->size()))
                 : std::span<const float>();
  };
  std::vector<PointAttribute> carried;
  for (const auto& [name, is_byte] : names) carried.push_back({name, is_byte});
  return std::make_unique<ArraySource>(rows_in(positions), rows_in(normals), floats(weights),
                                       floats(attributes), std::move(carried));
}

py::dict to_dict(const ReconstructReport& report) {
  py::dict found;
  found["points"] = report.points;
  found["dropped"] = report.dropped;
  found["outliers"] = report.outliers;
  found["vertices"] = report.vertices;
  found["triangles"] = report.triangles;
  found["is_flipped"] = report.is_flipped;
  found["residual"] = report.residual;
  found["cell"] = report.cell;
  found["is_spilled"] = report.is_spilled;
  return found;
}

std::tuple<Array<double>, Array<std::int32_t>, Array<float>, py::dict> bound_reconstruct(
    PointSource* source, const ReconstructOptions& options) {
  ArraySink sink;
  ReconstructReport report;
  {
    const py::gil_scoped_release unlocked;
    report = reconstruct(source, options, &sink);
  }
  const auto vertices = static_cast<py::ssize_t>(report.vertices);
  const auto triangles = static_cast<py::ssize_t>(report.triangles);
  const auto width = static_cast<py::ssize_t>(source->attributes().size());
  return {to_array<double>(sink.take_positions(), {vertices, 3}),
          to_array<std::int32_t>(sink.take_triangles(), {triangles, 3}),
          to_array<float>(sink.take_attributes(), {vertices, width}), to_dict(report)};
}

py::dict bound_reconstruct_file(PointSource* source, const std::string& target,
                                const ReconstructOptions& options) {
  ReconstructReport report;
  {
    const py::gil_scoped_release unlocked;
    PlyMeshWriter writer(target, source->attributes(), source->is_double());
    ReconstructOptions most = options;
    most.progress = options.progress.part(0.0, 0.95);
    report = reconstruct(source, most, &writer);
    writer.finish(options.progress.part(0.95, 1.0));
  }
  return to_dict(report);
}

}  // namespace

void bind_reconstruct(py::module_& m) {
  py::class_<ReconstructOptions>(m, "ReconstructOptions")
      .def(py::init(&options_of), py::arg("depth"), py::arg("wavelet"), py::arg("smooth"),
           py::arg("isovalue"), py::arg("are_sides_known"), py::arg("fit"), py::arg("trim"),
           py::arg("memory_limit"), py::arg("folder"), py::arg("progress"), py::arg("threads"),
           py::keep_alive<1, 11>());
  // The arrays are to live as long as it does.
  py::class_<ArraySource, PointSource>(m, "ArrayPoints")
      .def(py::init(&array_points), py::arg("positions"), py::arg("normals"), py::arg("weights"),
           py::arg("attributes"), py::arg("names"), py::keep_alive<1, 2>(), py::keep_alive<1, 3>(),
           py::keep_alive<1, 4>(), py::keep_alive<1, 5>());
  m.def("reconstruct", &bound_reconstruct, py::arg("source"), py::arg("options"));
  m.def("reconstruct_file", &bound_reconstruct_file, py::arg("source"), py::arg("target"),
        py::arg("options"));
}

}  // namespace prefilter::python
