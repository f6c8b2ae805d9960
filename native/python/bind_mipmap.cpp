// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <algorithm>
#include <tuple>

#include "convert.h"
#include "instances.h"
#include "prefilter/base/error.h"
#include "prefilter/base/names.h"
#include "prefilter/color/transfer.h"
#include "prefilter/mipmap/mipmap_error.h"
#include "prefilter/mipmap/mipmaps.h"
#include "prefilter/mipmap/seams.h"
#include "prefilter/mipmap/texture_use.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

MipmapOptions to_options(const std::string& filter, const WrapNames& wrap, std::optional<float> low,
                         std::optional<float> high, int levels, bool premultiplied,
                         const std::string& reader, double seam_budget, double footprint,
                         const py::object& progress, int threads) {
  MipmapOptions options;
  options.filter = mipmap_filter(filter);
  options.wrap = wrap_modes(wrap);
  options.bounds = {low, high};
  options.levels = levels;
  options.premultiplied = premultiplied;
  options.reader = value_named("reader", reader, kReaders);
  options.seam_budget = seam_budget;
  options.footprint = footprint;
  options.threads = threads;
  options.progress = to_progress(progress);
  return options;
}

template <typename... Options>
std::vector<Array<float>> bound_mipmaps(const Array<float>& array,
                                        const std::vector<const Surface*>& surfaces,
                                        Options... given) {
  const MipmapOptions options = to_options(given...);
  const ImageView image = view_of(array);
  std::vector<Image> images;
  {
    const py::gil_scoped_release unlocked;
    images = coarser_levels(image, surfaces, options);
  }
  return to_arrays(std::move(images));
}

std::vector<Image> coarser_levels_of(const Array<std::uint8_t>& array, bool srgb,
                                     const std::vector<const Surface*>& surfaces,
                                     const MipmapOptions& options) {
  const ByteValues values = byte_values(srgb);
  const TexelSource image(array.data(), static_cast<int>(array.shape(1)),
                          static_cast<int>(array.shape(0)), static_cast<int>(array.shape(2)),
                          &values);
  const py::gil_scoped_release unlocked;
  return coarser_levels(image, surfaces, options);
}

template <typename... Options>
std::vector<Array<float>> bound_float_levels_of_bytes(const Array<std::uint8_t>& array, bool srgb,
                                                      const std::vector<const Surface*>& surfaces,
                                                      Options... given) {
  return to_arrays(coarser_levels_of(array, srgb, surfaces, to_options(given...)));
}

template <typename... Options>
std::vector<Array<std::uint8_t>> bound_byte_mipmaps(const Array<std::uint8_t>& array, bool srgb,
                                                    const std::vector<const Surface*>& surfaces,
                                                    Options... given) {
  const MipmapOptions options = to_options(given...);
  std::vector<Image> images = coarser_levels_of(array, srgb, surfaces, options);
  std::vector<Array<std::uint8_t>> arrays;
  for (Image& level : images) {
    std::vector<std::uint8_t> bytes;
    {
      const py::gil_scoped_release unlocked;
      bytes = to_bytes(level.view(), srgb, options.threads);
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
  const Progress reporter = to_progress(progress);
  const py::gil_scoped_release unlocked;
  return mipmap_error(views, image, surfaces, mip_values, modes, reads, reporter, threads);
}

std::vector<double> bound_seam_contrast(const std::vector<Array<float>>& levels,
                                        const std::vector<const Surface*>& surfaces,
                                        const WrapNames& wrap, const py::object& progress) {
  const std::vector<ImageView> views = views_of(levels);
  const WrapModes modes = wrap_modes(wrap);
  const Progress reporter = to_progress(progress);
  const py::gil_scoped_release unlocked;
  return seam_contrast(views, surfaces, modes, reporter);
}

Array<float> bound_texel_weights(const std::vector<const Surface*>& surfaces, int width, int height,
                                 const WrapNames& wrap, const py::object& progress, int threads) {
  const WrapModes modes = wrap_modes(wrap);
  const Progress reporter = to_progress(progress);
  Image weights;
  {
    const py::gil_scoped_release unlocked;
    weights = texel_weights(surfaces, width, height, modes, reporter, threads);
  }
  return to_array(std::move(weights));
}

Array<float> bound_fill_transparent(const Array<float>& array, const WrapNames& wrap,
                                    const py::object& progress, int threads) {
  const ImageView image = view_of(array);
  const WrapModes modes = wrap_modes(wrap);
  const Progress reporter = to_progress(progress);
  Image filled;
  {
    const py::gil_scoped_release unlocked;
    filled = fill_transparent(image, modes, reporter, threads);
  }
  return to_array(std::move(filled));
}

Array<float> bound_fill_unused(const Array<float>& array,
                               const std::vector<const Surface*>& surfaces, const WrapNames& wrap,
                               const py::object& progress, int threads) {
  const ImageView image = view_of(array);
  const WrapModes modes = wrap_modes(wrap);
  const Progress reporter = to_progress(progress);
  Image filled;
  {
    const py::gil_scoped_release unlocked;
    filled = fill_unused(image, surfaces, modes, reporter, threads);
  }
  return to_array(std::move(filled));
}

}  // namespace

void bind_mipmap(py::module_& m) {
  using ForFloats = std::vector<Array<float>> (*)(
      const Array<float>&, const std::vector<const Surface*>&, std::string, WrapNames,
      std::optional<float>, std::optional<float>, int, bool, std::string, double, double,
      py::object, int);
  using ForBytes = std::vector<Array<std::uint8_t>> (*)(
      const Array<std::uint8_t>&, bool, const std::vector<const Surface*>&, std::string, WrapNames,
      std::optional<float>, std::optional<float>, int, bool, std::string, double, double,
      py::object, int);
  using ForFloatsOfBytes = std::vector<Array<float>> (*)(
      const Array<std::uint8_t>&, bool, const std::vector<const Surface*>&, std::string, WrapNames,
      std::optional<float>, std::optional<float>, int, bool, std::string, double, double,
      py::object, int);
  m.def("mipmap_filters", [] {
    std::vector<std::tuple<std::string, bool, bool>> filters;
    for (const MipmapFilter& filter : mipmap_filters()) {
      filters.emplace_back(name_of(filter), needs_surface(filter), is_fit(filter));
    }
    return filters;
  });
  m.def("coarser_levels", static_cast<ForFloats>(&bound_mipmaps), py::arg("image"),
        py::arg("surfaces"), py::arg("filter"), py::arg("wrap"), py::arg("low"), py::arg("high"),
        py::arg("levels"), py::arg("premultiplied"), py::arg("reader"), py::arg("seam_budget"),
        py::arg("footprint"), py::arg("progress"), py::arg("threads"));
  m.def("coarser_byte_levels", static_cast<ForBytes>(&bound_byte_mipmaps), py::arg("image"),
        py::arg("srgb"), py::arg("surfaces"), py::arg("filter"), py::arg("wrap"), py::arg("low"),
        py::arg("high"), py::arg("levels"), py::arg("premultiplied"), py::arg("reader"),
        py::arg("seam_budget"), py::arg("footprint"), py::arg("progress"), py::arg("threads"));
  m.def("coarser_float_levels_of_bytes",
        static_cast<ForFloatsOfBytes>(&bound_float_levels_of_bytes), py::arg("image"),
        py::arg("srgb"), py::arg("surfaces"), py::arg("filter"), py::arg("wrap"), py::arg("low"),
        py::arg("high"), py::arg("levels"), py::arg("premultiplied"), py::arg("reader"),
        py::arg("seam_budget"), py::arg("footprint"), py::arg("progress"), py::arg("threads"));
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
