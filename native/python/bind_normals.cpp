// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "convert.h"
#include "instances.h"
#include "prefilter/mipmap/normal_mipmaps.h"

namespace py = pybind11;

namespace prefilter::python {

void bind_normals(py::module_& m) {
  m.def(
      "normal_mipmaps",
      [](const Array<float>& normals, const std::optional<Array<float>>& roughness,
         const std::vector<const Surface*>& surfaces, const std::string& filter,
         const WrapNames& wrap, double footprint, bool encoded, int levels,
         const py::object& progress, int threads) {
        NormalMipmapOptions options;
        options.filter = mipmap_filter(filter);
        options.wrap = wrap_modes(wrap);
        options.footprint = footprint;
        options.encoded = encoded;
        options.levels = levels;
        options.threads = threads;
        options.progress = to_progress(progress);
        const ImageView normals_view = view_of(normals);
        const ImageView roughness_view = roughness ? view_of(*roughness) : ImageView();
        NormalMipmaps made;
        {
          const py::gil_scoped_release unlocked;
          made = normal_mipmaps(normals_view, roughness ? &roughness_view : nullptr, surfaces,
                                options);
        }
        return std::pair(to_arrays(std::move(made.normals)), to_arrays(std::move(made.roughness)));
      },
      py::arg("normals"), py::arg("roughness"), py::arg("surfaces"), py::arg("filter"),
      py::arg("wrap"), py::arg("footprint"), py::arg("encoded"), py::arg("levels"),
      py::arg("progress"), py::arg("threads"));
}

}  // namespace prefilter::python
