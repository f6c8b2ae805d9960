// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "convert.h"
#include "instances.h"
#include "prefilter/mipmap/keep_coverage.h"

namespace py = pybind11;

namespace prefilter::python {

void bind_cutout(py::module_& m) {
  m.def(
      "keep_coverage",
      [](const std::vector<Array<float>>& levels, const std::vector<const Surface*>& surfaces,
         double threshold, const WrapNames& wrap, bool premultiplied, const py::object& progress,
         int threads) {
        CoverageOptions options;
        options.threshold = threshold;
        options.wrap = wrap_modes(wrap);
        options.premultiplied = premultiplied;
        options.threads = threads;
        options.progress = to_progress(progress);
        const std::vector<ImageView> views = views_of(levels);
        std::vector<Image> kept;
        {
          const py::gil_scoped_release unlocked;
          kept = keep_coverage(views, surfaces, options);
        }
        return to_arrays(std::move(kept));
      },
      py::arg("levels"), py::arg("surfaces"), py::arg("threshold"), py::arg("wrap"),
      py::arg("premultiplied"), py::arg("progress"), py::arg("threads"));
}

}  // namespace prefilter::python
