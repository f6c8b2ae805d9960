// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "convert.h"
#include "prefilter/base/names.h"
#include "prefilter/cloud/align_scans.h"
#include "prefilter/cloud/outliers.h"
#include "prefilter/cloud/subsample.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

Array<std::int64_t> bound_subsample(const Array<double>& points, double spacing,
                                    const std::string& method, const py::object& callback,
                                    int threads) {
  const Progress progress = to_progress(callback);
  const Subsampling chosen = value_named("method", method, kSubsamplingNames);
  std::vector<std::int64_t> kept;
  {
    const py::gil_scoped_release unlocked;
    kept = subsample(rows_of(points), spacing, chosen, progress, threads);
  }
  const auto count = static_cast<py::ssize_t>(kept.size());
  return to_array<std::int64_t>(std::move(kept), {count});
}

Array<bool> bound_find_outliers(const Array<double>& points, int neighbours, double factor,
                                const py::object& callback, int threads) {
  const Progress progress = to_progress(callback);
  std::vector<bool> found;
  {
    const py::gil_scoped_release unlocked;
    found = find_outliers(rows_of(points), neighbours, factor, progress, threads);
  }
  Array<bool> result(static_cast<py::ssize_t>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) {
    result.mutable_at(static_cast<py::ssize_t>(i)) = found[i];
  }
  return result;
}

using Scan = std::pair<Array<double>, Array<double>>;

// The matrices, (scans, 4, 4), the median distances before and after, and the numbers of pairs.
py::tuple bound_align_scans(const std::vector<Scan>& scans, std::optional<double> reach,
                            int iterations, const py::object& callback, int threads) {
  std::vector<ScanView> views;
  for (const auto& [positions, normals] : scans) {
    views.push_back({rows_of(positions), rows_of(normals)});
  }
  const AlignOptions options{reach, iterations, to_progress(callback), threads};
  Alignment found;
  {
    const py::gil_scoped_release unlocked;
    found = align_scans(views, options);
  }
  const auto count = static_cast<py::ssize_t>(scans.size());
  Array<double> matrices({count, py::ssize_t{4}, py::ssize_t{4}});
  for (py::ssize_t s = 0; s < count; ++s) {
    const RigidMotion& motion = found.motions[static_cast<std::size_t>(s)];
    for (py::ssize_t r = 0; r < 4; ++r) {
      const auto row = static_cast<std::size_t>(r);
      for (py::ssize_t c = 0; c < 3; ++c) {
        const auto column = static_cast<std::size_t>(c);
        matrices.mutable_at(s, r, c) = r < 3 ? motion.rows[row][column] : 0.0;
      }
      matrices.mutable_at(s, r, 3) = r < 3 ? motion.shift[row] : 1.0;
    }
  }
  return py::make_tuple(std::move(matrices), found.before, found.after, py::cast(found.pairs));
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
}

}  // namespace prefilter::python
