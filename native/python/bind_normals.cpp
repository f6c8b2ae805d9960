// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "bind_options.h"
#include "convert.h"
#include "instances.h"
#include "prefilter/textures/normal_mipmaps.h"

namespace py = pybind11;

namespace prefilter::python {

void bind_normals(py::module_& m) {
  using Options = NormalMipmapOptions;
  bind_options<Options>(m, "NormalMipmapOptions")
      .def_property(
          "filter", [](const Options& o) { return name_of(o.filter); },
          [](Options& o, const std::string& name) { o.filter = mipmap_filter(name); })
      .def_readwrite("footprint", &Options::footprint)
      .def_readwrite("encoded", &Options::encoded)
      .def_readwrite("levels", &Options::levels);
  m.def(
      "normal_mipmaps",
      [](const Array<float>& normals, const std::optional<Array<float>>& roughness,
         const std::vector<const Surface*>& surfaces, Options options, const py::object& progress) {
        options.run = to_run(progress, options.run.threads());
        const ImageView normals_view = view_of(normals);
        const ImageView roughness_view = roughness ? view_of(*roughness) : ImageView();
        NormalMipmaps mipmaps;
        {
          const py::gil_scoped_release unlocked;
          mipmaps = normal_mipmaps(normals_view, roughness ? &roughness_view : nullptr, surfaces,
                                   options);
        }
        return std::pair(to_arrays(std::move(mipmaps.normals)),
                         to_arrays(std::move(mipmaps.roughness)));
      },
      py::arg("normals"), py::arg("roughness"), py::arg("surfaces"), py::arg("options"),
      py::arg("progress"));
}

}  // namespace prefilter::python
