// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "convert.h"
#include "prefilter/base/names.h"
#include "prefilter/points/align_scans.h"
#include "prefilter/points/align_to_surface.h"
#include "prefilter/points/outliers.h"
#include "prefilter/points/paint_texture.h"
#include "prefilter/points/subsample.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

Array<std::int64_t> bound_subsample(const Array<double>& points, double spacing,
                                    const std::string& method, const py::object& callback,
                                    int threads) {
  const Run run = to_run(callback, threads);
  const Subsampling chosen = value_named("method", method, kSubsamplingNames);
  std::vector<std::int64_t> kept;
  {
    const py::gil_scoped_release unlocked;
    kept = subsample(rows_of(points), spacing, chosen, run);
  }
  const auto count = static_cast<py::ssize_t>(kept.size());
  return to_array<std::int64_t>(std::move(kept), {count});
}

Array<bool> bound_find_outliers(const Array<double>& points, int neighbours, double factor,
                                const py::object& callback, int threads) {
  const Run run = to_run(callback, threads);
  std::vector<bool> is_outlier;
  {
    const py::gil_scoped_release unlocked;
    is_outlier = find_outliers(rows_of(points), neighbours, factor, run);
  }
  Array<bool> result(static_cast<py::ssize_t>(is_outlier.size()));
  for (std::size_t i = 0; i < is_outlier.size(); ++i) {
    result.mutable_at(static_cast<py::ssize_t>(i)) = is_outlier[i];
  }
  return result;
}

using Scan = std::pair<Array<double>, Array<double>>;

std::vector<ScanView> views_of(const std::vector<Scan>& scans) {
  std::vector<ScanView> views;
  for (const auto& [positions, normals] : scans) {
    views.push_back({rows_of(positions), rows_of(normals)});
  }
  return views;
}

// Matrices (scans, 4, 4), median distances before and after, and numbers of pairs.
py::tuple to_tuple(const Alignment& alignment) {
  const auto count = static_cast<py::ssize_t>(alignment.motions.size());
  Array<double> matrices({count, py::ssize_t{4}, py::ssize_t{4}});
  for (py::ssize_t s = 0; s < count; ++s) {
    const RigidMotion& motion = alignment.motions[static_cast<std::size_t>(s)];
    for (py::ssize_t r = 0; r < 4; ++r) {
      const auto row = static_cast<std::size_t>(r);
      for (py::ssize_t c = 0; c < 3; ++c) {
        const auto column = static_cast<std::size_t>(c);
        matrices.mutable_at(s, r, c) = r < 3 ? motion.rows[row][column] : 0.0;
      }
      matrices.mutable_at(s, r, 3) = r < 3 ? motion.shift[row] : 1.0;
    }
  }
  return py::make_tuple(std::move(matrices), alignment.before, alignment.after,
                        py::cast(alignment.pairs));
}

py::tuple bound_align_scans(const std::vector<Scan>& scans, std::optional<double> reach,
                            int iterations, const py::object& callback, int threads) {
  const AlignOptions options{reach, iterations, to_run(callback, threads)};
  const std::vector<ScanView> views = views_of(scans);
  Alignment alignment;
  {
    const py::gil_scoped_release unlocked;
    alignment = align_scans(views, options);
  }
  return to_tuple(alignment);
}

// `matrices` has one matrix per scan.
py::tuple bound_align_to_surface(const std::vector<Scan>& scans,
                                 const std::vector<Array<double>>& matrices,
                                 const Array<double>& positions,
                                 const Array<std::int32_t>& triangles, std::optional<double> reach,
                                 int iterations, const py::object& callback, int threads) {
  const AlignOptions options{reach, iterations, to_run(callback, threads)};
  const std::vector<ScanView> views = views_of(scans);
  std::vector<RigidMotion> motions;
  for (const Array<double>& matrix : matrices) motions.push_back(motion_of(matrix));
  Alignment alignment;
  {
    const py::gil_scoped_release unlocked;
    alignment = align_to_surface(views, motions, {rows_of(positions), rows_of(triangles)}, options);
  }
  return to_tuple(alignment);
}

std::pair<Array<float>, std::size_t> bound_paint_texture(
    const Surface& surface, const Array<double>& points, const Array<float>& values, int width,
    int height, const WrapNames& wrap, double smoothing, std::optional<double> reach,
    const py::object& callback, int threads) {
  const PaintOptions options{width,     height, wrap_modes(wrap),
                             smoothing, reach,  to_run(callback, threads)};
  const auto channels = static_cast<int>(values.shape(1));
  const auto span = std::span(values.data(), static_cast<std::size_t>(values.size()));
  PaintedTexture painted;
  {
    const py::gil_scoped_release unlocked;
    painted = paint_texture(surface, rows_of(points), span, channels, options);
  }
  return {to_array(std::move(painted.image)), painted.points};
}

}  // namespace

void bind_cloud(py::module_& m) {
  m.attr("SUBSAMPLING") = names_of(kSubsamplingNames);
  m.def("subsample", &bound_subsample, py::arg("points"), py::arg("spacing"), py::arg("method"),
        py::arg("progress"), py::arg("threads"));
  m.def("find_outliers", &bound_find_outliers, py::arg("points"), py::arg("neighbours"),
        py::arg("factor"), py::arg("progress"), py::arg("threads"));
  m.def("align_scans", &bound_align_scans, py::arg("scans"), py::arg("reach"),
        py::arg("iterations"), py::arg("progress"), py::arg("threads"));
  m.def("align_to_surface", &bound_align_to_surface, py::arg("scans"), py::arg("matrices"),
        py::arg("positions"), py::arg("triangles"), py::arg("reach"), py::arg("iterations"),
        py::arg("progress"), py::arg("threads"));
  m.def("paint_texture", &bound_paint_texture, py::arg("surface"), py::arg("points"),
        py::arg("values"), py::arg("width"), py::arg("height"), py::arg("wrap"),
        py::arg("smoothing"), py::arg("reach"), py::arg("progress"), py::arg("threads"));
}

}  // namespace prefilter::python
