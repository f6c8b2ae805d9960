// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "bind_options.h"
#include "convert.h"
#include "instances.h"
#include "prefilter/textures/keep_coverage.h"

namespace py = pybind11;

namespace prefilter::python {

void bind_cutout(py::module_& m) {
  bind_options<CoverageOptions>(m, "CoverageOptions")
      .def_readwrite("threshold", &CoverageOptions::threshold);
  m.def(
      "keep_coverage",
      [](const std::vector<Array<float>>& levels, const std::vector<const Surface*>& surfaces,
         CoverageOptions options, const py::object& progress) {
        options.run = to_run(progress, options.run.threads());
        const std::vector<ImageView> views = views_of(levels);
        std::vector<Image> kept;
        {
          const py::gil_scoped_release unlocked;
          kept = keep_coverage(views, surfaces, options);
        }
        return to_arrays(std::move(kept));
      },
      py::arg("levels"), py::arg("surfaces"), py::arg("options"), py::arg("progress"));
}

}  // namespace prefilter::python
