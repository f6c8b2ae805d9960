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
#include "prefilter/base/error.h"
#include "prefilter/reconstruct/reconstruct.h"
#include "prefilter/scan/arrays.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

WaveletBasis basis_of(const std::string& name) {
  if (name == "haar") return WaveletBasis::kHaar;
  if (name == "d4") return WaveletBasis::kD4;
  throw_invalid("wavelet: '" + name + "' is not one of haar, d4");
}

ReconstructOptions options_of(int depth, const std::string& wavelet, bool smooth,
                              const std::variant<double, std::string>& isovalue, bool fit,
                              const std::optional<double>& trim,
                              const std::optional<std::uint64_t>& memory_limit,
                              const py::object& progress, int threads) {
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
  options.fit = fit;
  options.trim = trim;
  if (memory_limit) options.memory_limit = *memory_limit;
  options.threads = threads;
  options.progress = to_progress(progress);
  return options;
}

using Rows = std::variant<Array<float>, Array<double>>;

VectorRows rows_in(const Rows& arrays) {
  return std::visit([](const auto& array) -> VectorRows { return rows_of(array); }, arrays);
}

std::tuple<Array<double>, Array<std::int64_t>, Array<float>, ReconstructReport> bound_reconstruct(
    const Rows& points, const Rows& normals, const std::optional<Array<float>>& weights,
    const std::optional<Array<float>>& attributes, int depth, const std::string& wavelet,
    bool smooth, const std::variant<double, std::string>& isovalue, bool fit,
    const std::optional<double>& trim, const std::optional<std::uint64_t>& memory_limit,
    const py::object& progress, int threads) {
  const ReconstructOptions options =
      options_of(depth, wavelet, smooth, isovalue, fit, trim, memory_limit, progress, threads);
  const auto floats = [](const std::optional<Array<float>>& array) {
    return array ? std::span(array->data(), static_cast<std::size_t>(array->size()))
                 : std::span<const float>();
  };
  const py::ssize_t width = attributes ? attributes->shape(1) : 0;
  ArraySource source(rows_in(points), rows_in(normals), floats(weights), floats(attributes),
                     std::vector<PointAttribute>(static_cast<std::size_t>(width)));
  ArraySink sink;
  ReconstructReport report;
  {
    const py::gil_scoped_release unlocked;
    report = reconstruct(&source, options, &sink);
  }
  const auto vertices = static_cast<py::ssize_t>(sink.positions.size());
  const auto triangles = static_cast<py::ssize_t>(sink.triangles.size());
  return {to_array<double>(std::move(sink.positions), {vertices, 3}),
          to_array<std::int64_t>(std::move(sink.triangles), {triangles, 3}),
          to_array<float>(std::move(sink.attributes), {vertices, width}), report};
}

}  // namespace

void bind_reconstruct(py::module_& m) {
  py::class_<ReconstructReport>(m, "ReconstructReport")
      .def_readonly("points", &ReconstructReport::points)
      .def_readonly("dropped", &ReconstructReport::dropped)
      .def_readonly("outliers", &ReconstructReport::outliers)
      .def_readonly("vertices", &ReconstructReport::vertices)
      .def_readonly("triangles", &ReconstructReport::triangles)
      .def_readonly("is_flipped", &ReconstructReport::is_flipped)
      .def_readonly("residual", &ReconstructReport::residual)
      .def_readonly("cell", &ReconstructReport::cell)
      .def_readonly("is_spilled", &ReconstructReport::is_spilled);
  m.def("reconstruct", &bound_reconstruct, py::arg("points"), py::arg("normals"),
        py::arg("weights"), py::arg("attributes"), py::arg("depth"), py::arg("wavelet"),
        py::arg("smooth"), py::arg("isovalue"), py::arg("fit"), py::arg("trim"),
        py::arg("memory_limit"), py::arg("progress"), py::arg("threads"));
}

}  // namespace prefilter::python
