// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "convert.h"
#include "prefilter/filters/pixel_filter.h"
#include "prefilter/resize/resize.h"

namespace py = pybind11;

namespace prefilter::python {

void bind_resize(py::module_& m) {
  m.def("pixel_filters", [] {
    py::list filters;
    for (const PixelFilter& filter : pixel_filters()) {
      py::list uses;
      for (const FilterUse use : filter.uses) uses.append(name_in(kFilterUses, use));
      filters.append(py::make_tuple(filter.name, filter.label, filter.radius, py::tuple(uses)));
    }
    return filters;
  });
  m.def(
      "resize",
      [](const Array<float>& array, int width, int height, const std::string& filter,
         bool constrained, const WrapNames& wrap, bool premultiplied, const py::object& progress,
         int threads) {
        const ImageView image = view_of(array);
        ResizeOptions options;
        options.filter = resize_filter(filter);
        options.constrained = constrained;
        options.wrap = wrap_modes(wrap);
        options.premultiplied = premultiplied;
        options.threads = threads;
        options.progress = to_progress(progress);
        Image result;
        {
          const py::gil_scoped_release unlocked;
          result = resize(image, width, height, options);
        }
        return to_array(std::move(result));
      },
      py::arg("image"), py::arg("width"), py::arg("height"), py::arg("filter"),
      py::arg("constrained"), py::arg("wrap"), py::arg("premultiplied"), py::arg("progress"),
      py::arg("threads"));
}

}  // namespace prefilter::python
