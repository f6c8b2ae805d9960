// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bind_options.h"
#include "convert.h"
#include "instances.h"
#include "prefilter/base/error.h"
#include "prefilter/base/names.h"
#include "prefilter/images/transfer.h"
#include "prefilter/textures/mipmap_error.h"
#include "prefilter/textures/mipmaps.h"
#include "prefilter/textures/seams.h"
#include "prefilter/textures/texture_use.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

using Surfaces = std::vector<const Surface*>;

void bind_mipmap_options(py::module_& m) {
  using Options = MipmapOptions;
  auto bound = bind_options<Options>(m, "MipmapOptions");
  bind_named(bound, "reader", &Options::reader, kReaders);
  bound
      .def_property(
          "filter", [](const Options& o) { return name_of(o.filter); },
          [](Options& o, const std::string& name) { o.filter = mipmap_filter(name); })
      .def_readwrite("levels", &Options::levels)
      .def_readwrite("seam_budget", &Options::seam_budget)
      .def_readwrite("footprint", &Options::footprint);
}

std::vector<Array<float>> bound_float_levels(const Array<float>& array, const Surfaces& surfaces,
                                             MipmapOptions options, const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const ImageView image = view_of(array);
  std::vector<Image> images;
  {
    const py::gil_scoped_release unlocked;
    images = coarser_levels(image, surfaces, options);
  }
  return to_arrays(std::move(images));
}

std::vector<Image> levels_of_bytes(const Array<std::uint8_t>& array, bool srgb,
                                   const Surfaces& surfaces, MipmapOptions options,
                                   const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const ByteValues values = byte_values(srgb);
  const TexelSource image = bytes_of(array, &values);
  const py::gil_scoped_release unlocked;
  return coarser_levels(image, surfaces, options);
}

std::vector<Array<float>> bound_float_levels_of_bytes(const Array<std::uint8_t>& array, bool srgb,
                                                      const Surfaces& surfaces,
                                                      const MipmapOptions& options,
                                                      const py::object& progress) {
  return to_arrays(levels_of_bytes(array, srgb, surfaces, options, progress));
}

std::vector<Array<std::uint8_t>> bound_byte_levels(const Array<std::uint8_t>& array, bool srgb,
                                                   const Surfaces& surfaces,
                                                   const MipmapOptions& options,
                                                   const py::object& progress) {
  std::vector<Image> images = levels_of_bytes(array, srgb, surfaces, options, progress);
  std::vector<Array<std::uint8_t>> arrays;
  for (Image& level : images) {
    std::vector<std::uint8_t> bytes;
    {
      const py::gil_scoped_release unlocked;
      bytes = to_bytes(level.view(), srgb, options.run.threads());
    }
    Array<std::uint8_t> result({level.height, level.width, level.channels});
    std::copy(bytes.begin(), bytes.end(), result.mutable_data());
    level = Image();
    arrays.push_back(std::move(result));
  }
  return arrays;
}

std::vector<double> bound_mipmap_error(const std::vector<Array<float>>& levels,
                                       const Array<float>& array,
                                       const std::vector<const Surface*>& surfaces,
                                       const std::vector<double>& mip_values, const WrapNames& wrap,
                                       const std::string& reader, const py::object& progress,
                                       int threads) {
  const std::vector<ImageView> views = views_of(levels);
  const ImageView image = view_of(array);
  const WrapModes modes = wrap_modes(wrap);
  const Reader reads = value_named("reader", reader, kReaders);
  const Run reporter = to_run(progress, threads);
  const py::gil_scoped_release unlocked;
  return mipmap_error(views, image, surfaces, mip_values, modes, reads, reporter);
}

std::vector<double> bound_seam_contrast(const std::vector<Array<float>>& levels,
                                        const std::vector<const Surface*>& surfaces,
                                        const WrapNames& wrap, const py::object& progress) {
  const std::vector<ImageView> views = views_of(levels);
  const WrapModes modes = wrap_modes(wrap);
  const Run reporter = to_run(progress);
  const py::gil_scoped_release unlocked;
  return seam_contrast(views, surfaces, modes, reporter);
}

Array<float> bound_texel_weights(const std::vector<const Surface*>& surfaces, int width, int height,
                                 const WrapNames& wrap, const py::object& progress, int threads) {
  const WrapModes modes = wrap_modes(wrap);
  const Run reporter = to_run(progress, threads);
  Image weights;
  {
    const py::gil_scoped_release unlocked;
    weights = texel_weights(surfaces, width, height, modes, reporter);
  }
  return to_array(std::move(weights));
}

Array<float> bound_fill_transparent(const Array<float>& array, const WrapNames& wrap,
                                    const py::object& progress, int threads) {
  const ImageView image = view_of(array);
  const WrapModes modes = wrap_modes(wrap);
  const Run reporter = to_run(progress, threads);
  Image filled;
  {
    const py::gil_scoped_release unlocked;
    filled = fill_transparent(image, modes, reporter);
  }
  return to_array(std::move(filled));
}

Array<float> bound_fill_unused(const Array<float>& array,
                               const std::vector<const Surface*>& surfaces, const WrapNames& wrap,
                               const py::object& progress, int threads) {
  const ImageView image = view_of(array);
  const WrapModes modes = wrap_modes(wrap);
  const Run reporter = to_run(progress, threads);
  Image filled;
  {
    const py::gil_scoped_release unlocked;
    filled = fill_unused(image, surfaces, modes, reporter);
  }
  return to_array(std::move(filled));
}

}  // namespace

void bind_mipmap(py::module_& m) {
  bind_mipmap_options(m);
  m.def("mipmap_filters", [] {
    std::vector<std::tuple<std::string, bool, bool>> filters;
    for (const MipmapFilter& filter : mipmap_filters()) {
      filters.emplace_back(name_of(filter), needs_surface(filter), is_fit(filter));
    }
    return filters;
  });
  m.def("coarser_levels", &bound_float_levels, py::arg("image"), py::arg("surfaces"),
        py::arg("options"), py::arg("progress"));
  m.def("coarser_byte_levels", &bound_byte_levels, py::arg("image"), py::arg("srgb"),
        py::arg("surfaces"), py::arg("options"), py::arg("progress"));
  m.def("coarser_float_levels_of_bytes", &bound_float_levels_of_bytes, py::arg("image"),
        py::arg("srgb"), py::arg("surfaces"), py::arg("options"), py::arg("progress"));
  m.def("mipmap_error", &bound_mipmap_error, py::arg("levels"), py::arg("image"),
        py::arg("surfaces"), py::arg("mip_values"), py::arg("wrap"), py::arg("reader"),
        py::arg("progress"), py::arg("threads"));
  m.def("seam_contrast", &bound_seam_contrast, py::arg("levels"), py::arg("surfaces"),
        py::arg("wrap"), py::arg("progress"));
  m.def("texel_weights", &bound_texel_weights, py::arg("surfaces"), py::arg("width"),
        py::arg("height"), py::arg("wrap"), py::arg("progress"), py::arg("threads"));
  m.def("fill_transparent", &bound_fill_transparent, py::arg("image"), py::arg("wrap"),
        py::arg("progress"), py::arg("threads"));
  m.def("fill_unused", &bound_fill_unused, py::arg("image"), py::arg("surfaces"), py::arg("wrap"),
        py::arg("progress"), py::arg("threads"));
}

}  // namespace prefilter::python
