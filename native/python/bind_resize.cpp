// SPDX-License-Identifier: GPL-3.0-or-later

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bind_options.h"
#include "convert.h"
#include "prefilter/images/pixel_filter.h"
#include "prefilter/images/resize.h"
#include "prefilter/images/transfer.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

void bind_resize_options(py::module_& m) {
  using Options = ResizeOptions;
  py::class_<Options> bound = bind_options<Options>(m, "ResizeOptions");
  bind_named(bound, "ringing", &Options::ringing, kRingings);
  bound
      .def_property(
          "filter", [](const Options& o) { return name_of(o.filter); },
          [](Options& o, const std::string& name) { o.filter = resize_filter(name); })
      .def_readwrite("constrained", &Options::constrained);
}

Array<float> bound_resize(const Array<float>& array, int width, int height, ResizeOptions options,
                          const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const ImageView image = view_of(array);
  Image result;
  {
    const py::gil_scoped_release unlocked;
    result = resize(image, width, height, options);
  }
  return to_array(std::move(result));
}

Array<std::uint8_t> bound_resize_bytes(const Array<std::uint8_t>& array, bool srgb, int width,
                                       int height, ResizeOptions options,
                                       const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const ByteValues values = byte_values(srgb);
  const TexelSource image = bytes_of(array, &values);
  std::vector<std::uint8_t> bytes;
  {
    const py::gil_scoped_release unlocked;
    const Image result = resize(image, width, height, options);
    bytes = to_bytes(result.view(), srgb, options.run.threads());
  }
  return to_array<std::uint8_t>(std::move(bytes), {height, width, image.channels});
}

}  // namespace

void bind_resize(py::module_& m) {
  bind_resize_options(m);
  m.def("pixel_filters", [] {
    py::list filters;
    for (const PixelFilter& filter : pixel_filters()) {
      py::list uses;
      for (const FilterUse use : filter.uses) uses.append(name_in(kFilterUses, use));
      filters.append(py::make_tuple(filter.name, filter.label, filter.radius, py::tuple(uses)));
    }
    return filters;
  });
  m.def("resize_bytes", &bound_resize_bytes, py::arg("image"), py::arg("srgb"), py::arg("width"),
        py::arg("height"), py::arg("options"), py::arg("progress"));
  m.def("resize", &bound_resize, py::arg("image"), py::arg("width"), py::arg("height"),
        py::arg("options"), py::arg("progress"));
}

}  // namespace prefilter::python
