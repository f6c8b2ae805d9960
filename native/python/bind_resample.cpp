#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "convert.h"
#include "prefilter/sampling/sampling_levels.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

std::vector<Array<float>> bound_sampling_levels(const Array<float>& array,
                                                const std::string& filter, const WrapNames& wrap,
                                                int levels, bool premultiplied,
                                                const py::object& progress, int threads) {
  const ImageView image = view_of(array);
  SamplingLevelsOptions options;
  options.kernel = &kernel_named(filter);
  options.wrap = wrap_modes(wrap);
  options.levels = levels;
  options.premultiplied = premultiplied;
  options.threads = threads;
  options.progress = to_progress(progress);
  std::vector<Image> images;
  {
    const py::gil_scoped_release unlocked;
    images = sampling_levels(image, options);
  }
  return to_arrays(std::move(images));
}

}  // namespace

void bind_resample(py::module_& m) {
  m.def("sampling_filters", [] {
    std::vector<std::string> names;
    for (const Kernel& kernel : kernels()) names.emplace_back(kernel.name());
    return names;
  });
  m.def("sampling_levels", &bound_sampling_levels, py::arg("image"), py::arg("filter"),
        py::arg("wrap"), py::arg("levels"), py::arg("premultiplied"), py::arg("progress"),
        py::arg("threads"));
}

}  // namespace prefilter::python
