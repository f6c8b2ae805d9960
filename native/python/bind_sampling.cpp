// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <span>
#include <vector>

#include "bind_options.h"
#include "convert.h"
#include "instances.h"
#include "prefilter/sampling/sample.h"
#include "pyramids.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

Array<float> bound_sample(const std::vector<py::array>& levels, const SamplingTable* table,
                          const Array<double>& coordinates, const Array<double>& scales,
                          SampleOptions options, const py::object& progress) {
  const Pyramid pyramid = pyramid_of(levels);
  options.run = to_run(progress, options.run.threads());
  Array<float> result({coordinates.shape(0), static_cast<py::ssize_t>(pyramid.channels)});
  const std::span<const std::array<double, 2>> places(
      reinterpret_cast<const std::array<double, 2>*>(coordinates.data()),
      static_cast<std::size_t>(coordinates.shape(0)));
  const std::span<const double> widths(scales.data(), static_cast<std::size_t>(scales.size()));
  const std::span<float> values(result.mutable_data(), static_cast<std::size_t>(result.size()));
  {
    const py::gil_scoped_release unlocked;
    sample(pyramid, table, places, widths, options, values);
  }
  return result;
}

}  // namespace

void bind_sampling(py::module_& m) {
  bind_options<SampleOptions>(m, "SampleOptions");
  m.def("sample", &bound_sample, py::arg("levels"), py::arg("table"), py::arg("coordinates"),
        py::arg("scales"), py::arg("options"), py::arg("progress"));
}

}  // namespace prefilter::python
