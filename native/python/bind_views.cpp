// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <utility>
#include <vector>

#include "bind_options.h"
#include "convert.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/textures/fit_to_views.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

std::vector<Array<float>> bound_fit_to_views(const std::vector<Array<float>>& levels,
                                             const std::vector<const Surface*>& surfaces,
                                             ViewFitOptions options, const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const std::vector<ImageView> views = views_of(levels);
  std::vector<Image> images;
  {
    const py::gil_scoped_release unlocked;
    images = fit_to_views(views, surfaces, options);
  }
  return to_arrays(std::move(images));
}

}  // namespace

void bind_views(py::module_& m) {
  using Options = ViewFitOptions;
  auto bound = bind_options<Options>(m, "ViewFitOptions");
  bind_named(bound, "lookups", &Options::lookups, kLookups);
  bound.def_readwrite("steadiness", &Options::steadiness).def_readwrite("effort", &Options::effort);
  m.def("fit_to_views", &bound_fit_to_views, py::arg("levels"), py::arg("surfaces"),
        py::arg("options"), py::arg("progress"));
}

}  // namespace prefilter::python
