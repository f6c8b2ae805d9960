#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "convert.h"
#include "prefilter/mipmap/covered_share.h"

namespace py = pybind11;

namespace prefilter::python {

void bind_cutout(py::module_& m) {
  m.def(
      "covered_share",
      [](const Array<float>& alpha, const Array<float>& weights, int samples, float threshold,
         const std::pair<std::string, std::string>& wrap, const py::object& progress, int threads) {
        const ImageView alpha_view = view_of(alpha);
        const ImageView weights_view = view_of(weights);
        const WrapModes modes = {wrap_mode(wrap.first), wrap_mode(wrap.second)};
        const Progress reporter = to_progress(progress);
        const py::gil_scoped_release unlocked;
        return covered_share(alpha_view, weights_view, samples, threshold, modes, reporter,
                             threads);
      },
      py::arg("alpha"), py::arg("weights"), py::arg("samples"), py::arg("threshold"),
      py::arg("wrap"), py::arg("progress"), py::arg("threads"));
}

}  // namespace prefilter::python
