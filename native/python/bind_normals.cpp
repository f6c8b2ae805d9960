#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "convert.h"
#include "prefilter/mipmap/lookup_means.h"

namespace py = pybind11;

namespace prefilter::python {

void bind_normals(py::module_& m) {
  m.def(
      "lookup_means",
      [](const Array<float>& normals, const Array<float>& roughness,
         const std::pair<std::string, std::string>& wrap, float least_length,
         const py::object& progress, int threads) {
        const ImageView normals_view = view_of(normals);
        const ImageView roughness_view = view_of(roughness);
        const WrapModes modes = {wrap_mode(wrap.first), wrap_mode(wrap.second)};
        const Progress reporter = to_progress(progress);
        Image means;
        {
          const py::gil_scoped_release unlocked;
          means =
              lookup_means(normals_view, roughness_view, modes, least_length, reporter, threads);
        }
        return to_array(std::move(means));
      },
      py::arg("normals"), py::arg("roughness"), py::arg("wrap"), py::arg("least_length"),
      py::arg("progress"), py::arg("threads"));
}

}  // namespace prefilter::python
