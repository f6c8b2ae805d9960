// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bind_options.h"
#include "convert.h"
#include "instances.h"
#include "prefilter/base/error.h"
#include "prefilter/sampling/anisotropic.h"
#include "prefilter/sampling/elliptical.h"
#include "prefilter/sampling/exact.h"
#include "prefilter/sampling/resample.h"
#include "prefilter/sampling/sampling_levels.h"
#include "prefilter/sampling/stochastic.h"
#include "pyramids.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

std::span<const TexturePlace> places_of(const Array<double>& coordinates) {
  return {reinterpret_cast<const TexturePlace*>(coordinates.data()),
          static_cast<std::size_t>(coordinates.shape(0))};
}

// Matrices from an array of shape (samples, 2, 2).
std::span<const TextureJacobian> jacobians_of(const Array<double>& jacobians) {
  return {reinterpret_cast<const TextureJacobian*>(jacobians.data()),
          static_cast<std::size_t>(jacobians.shape(0))};
}

SamplePlaces sample_places(const Array<double>& coordinates, const Array<double>& scales) {
  return {places_of(coordinates), {scales.data(), static_cast<std::size_t>(scales.size())}};
}

void bind_sampling_options(py::module_& m) {
  auto exact = bind_options<ExactOptions>(m, "ExactOptions");
  bind_kernel(exact);
  bind_options<EllipticalOptions>(m, "EllipticalOptions");
  bind_options<AnisotropicOptions>(m, "AnisotropicOptions")
      .def_readwrite("max_probes", &AnisotropicOptions::max_probes);
  auto levels = bind_options<SamplingLevelsOptions>(m, "SamplingLevelsOptions");
  bind_kernel(levels);
  levels.def_readwrite("levels", &SamplingLevelsOptions::levels);
}

void bind_resample_options(py::module_& m) {
  using Options = ResampleOptions;
  auto bound = bind_options<Options>(m, "ResampleOptions");
  bind_kernel(bound);
  bound
      .def_property(
          "exact", [](const Options& o) { return o.method == Options::Method::kExact; },
          [](Options& o, bool exact) {
            o.method = exact ? Options::Method::kExact : Options::Method::kTrilinear;
          })
      .def_readwrite("max_probes", &Options::max_probes);
}

Array<float> to_samples(std::vector<float> values, const Array<double>& coordinates, int channels) {
  return to_array<float>(std::move(values), {coordinates.shape(0), py::ssize_t{channels}});
}

std::vector<Array<float>> bound_sampling_levels(const Array<float>& array,
                                                SamplingLevelsOptions options,
                                                const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const ImageView image = view_of(array);
  std::vector<Image> images;
  {
    const py::gil_scoped_release unlocked;
    images = sampling_levels(image, options);
  }
  return to_arrays(std::move(images));
}

Array<float> bound_sample_exact(const Array<float>& array, const Array<double>& coordinates,
                                const Array<double>& scales, ExactOptions options,
                                const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const ImageView image = view_of(array);
  std::vector<float> values;
  {
    const py::gil_scoped_release unlocked;
    values = sample_exactly(image, sample_places(coordinates, scales), options);
  }
  return to_samples(std::move(values), coordinates, image.channels);
}

Array<float> bound_sample_ewa(const Array<float>& array, const Array<double>& coordinates,
                              const Array<double>& jacobians, EllipticalOptions options,
                              const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const ImageView image = view_of(array);
  std::vector<float> values;
  {
    const py::gil_scoped_release unlocked;
    values = sample_elliptically(image, places_of(coordinates), jacobians_of(jacobians), options);
  }
  return to_samples(std::move(values), coordinates, image.channels);
}

Array<float> bound_sample_anisotropic(const std::vector<py::array>& levels,
                                      const SamplingTable* table, const Array<double>& coordinates,
                                      const Array<double>& jacobians, AnisotropicOptions options,
                                      const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const Pyramid pyramid = pyramid_of(levels);
  std::vector<float> values(static_cast<std::size_t>(coordinates.shape(0) * pyramid.channels));
  {
    const py::gil_scoped_release unlocked;
    sample_anisotropically(pyramid, table, places_of(coordinates), jacobians_of(jacobians), options,
                           values);
  }
  return to_samples(std::move(values), coordinates, pyramid.channels);
}

TexelChoice texel_choice(const SamplingTable* table, bool bilinear) {
  if (table != nullptr) return {TexelChoice::Kind::kTable, table};
  return {bilinear ? TexelChoice::Kind::kBilinear : TexelChoice::Kind::kTrilinear, nullptr};
}

Array<float> bound_sample_stochastic(const std::vector<py::array>& levels,
                                     const SamplingTable* table, bool bilinear,
                                     const Array<double>& coordinates, const Array<double>& scales,
                                     const Array<double>& numbers, SampleOptions options,
                                     const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const Pyramid pyramid = pyramid_of(levels);
  const std::span<const double> picks(numbers.data(), static_cast<std::size_t>(numbers.size()));
  std::vector<float> values(static_cast<std::size_t>(coordinates.shape(0) * pyramid.channels));
  {
    const py::gil_scoped_release unlocked;
    sample_stochastically(pyramid, texel_choice(table, bilinear),
                          sample_places(coordinates, scales), picks, options, values);
  }
  return to_samples(std::move(values), coordinates, pyramid.channels);
}

// Level, column, row and weight of each texel.
using PickedArrays = std::pair<Array<std::int32_t>, Array<double>>;

PickedArrays bound_pick_texels(const std::vector<py::array>& levels, const SamplingTable* table,
                               bool bilinear, const Array<double>& coordinates,
                               const Array<double>& scales, const Array<double>& numbers,
                               SampleOptions options, const py::object& progress) {
  options.run = to_run(progress, options.run.threads());
  const Pyramid pyramid = pyramid_of(levels);
  const std::span<const double> picks(numbers.data(), static_cast<std::size_t>(numbers.size()));
  std::vector<std::int32_t> texels;
  std::vector<double> weights;
  {
    const py::gil_scoped_release unlocked;
    for (const WeightedTexel& texel :
         pick_texels(pyramid, texel_choice(table, bilinear), sample_places(coordinates, scales),
                     picks, options)) {
      texels.insert(texels.end(), {texel.level, texel.x, texel.y});
      weights.push_back(texel.weight);
    }
  }
  const py::ssize_t count = coordinates.shape(0);
  return {to_array<std::int32_t>(std::move(texels), {count, 3}),
          to_array<double>(std::move(weights), {count})};
}

Array<float> bound_resample(const Array<float>& array, const Array<double>& transform, int width,
                            int height, const SamplingTable* table, ResampleOptions options,
                            const py::object& progress) {
  const ImageView image = view_of(array);
  Homography homography{};
  std::copy_n(transform.data(), homography.size(), homography.begin());
  options.run = to_run(progress, options.run.threads());
  if (table != nullptr) {
    options.method = ResampleOptions::Method::kTable;
    options.table = table;
  }
  Image result;
  {
    const py::gil_scoped_release unlocked;
    result = resample(image, homography, width, height, options);
  }
  return to_array(std::move(result));
}

}  // namespace

void bind_resample(py::module_& m) {
  bind_sampling_options(m);
  bind_resample_options(m);
  m.def("sampling_levels", &bound_sampling_levels, py::arg("image"), py::arg("options"),
        py::arg("progress"));
  m.def("sample_exact", &bound_sample_exact, py::arg("image"), py::arg("coordinates"),
        py::arg("scales"), py::arg("options"), py::arg("progress"));
  m.def("sample_ewa", &bound_sample_ewa, py::arg("image"), py::arg("coordinates"),
        py::arg("jacobians"), py::arg("options"), py::arg("progress"));
  m.def("sample_anisotropic", &bound_sample_anisotropic, py::arg("levels"), py::arg("table"),
        py::arg("coordinates"), py::arg("jacobians"), py::arg("options"), py::arg("progress"));
  m.def("sample_stochastic", &bound_sample_stochastic, py::arg("levels"), py::arg("table"),
        py::arg("bilinear"), py::arg("coordinates"), py::arg("scales"), py::arg("numbers"),
        py::arg("options"), py::arg("progress"));
  m.def("pick_texels", &bound_pick_texels, py::arg("levels"), py::arg("table"), py::arg("bilinear"),
        py::arg("coordinates"), py::arg("scales"), py::arg("numbers"), py::arg("options"),
        py::arg("progress"));
  m.def("resample", &bound_resample, py::arg("image"), py::arg("transform"), py::arg("width"),
        py::arg("height"), py::arg("table"), py::arg("options"), py::arg("progress"));
}

}  // namespace prefilter::python
