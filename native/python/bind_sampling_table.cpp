// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bind_options.h"
#include "convert.h"
#include "instances.h"
#include "prefilter/sampling/build_table.h"
#include "prefilter/sampling/jumps.h"
#include "prefilter/sampling/sampling_table.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

// Texels (subdomains, texels, 3), coefficients (subdomains, texels, terms); errors, trilinear
// errors and gaps (subdomains). Without a certificate there are no gaps.
using SectionArrays =
    std::tuple<Array<int>, Array<double>, Array<double>, Array<double>, Array<double>>;

void bind_table_shape(py::module_& m) {
  py::class_<TableShape> shape(m, "TableShape");
  shape.def(py::init<>())
      .def_readwrite("filter", &TableShape::filter)
      .def_readwrite("texels", &TableShape::texels)
      .def_readwrite("grid", &TableShape::grid)
      .def_readwrite("slices", &TableShape::slices)
      .def_readwrite("degree", &TableShape::degree)
      .def_readwrite("ramp_weight", &TableShape::ramp_weight)
      .def_readwrite("target", &TableShape::target);
  bind_named(shape, "spectrum", &TableShape::spectrum, kImageSpectra);
}

SamplingTable bound_build(const TableShape& shape, bool certify, const py::object& progress,
                          int threads) {
  const BuildTableOptions options{shape, certify, to_run(progress, threads)};
  const py::gil_scoped_release unlocked;
  return build_sampling_table(options);
}

std::vector<double> numbers_of(const Array<double>& array) {
  return {array.data(), array.data() + array.size()};
}

SamplingTable bound_make(const TableShape& shape, const std::array<SectionArrays, 3>& sections) {
  SamplingTable table;
  table.shape = shape;
  check_shape(table.shape);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const auto& [offsets, coefficients, errors, trilinear_errors, gaps] = sections[i];
    TableSection& section = table.sections[i];
    section.levels = 3 - static_cast<int>(i);
    section.slices = section.levels == 1 ? 1 : shape.slices;
    for (py::ssize_t k = 0; k + 2 < offsets.size(); k += 3) {
      const int* const offset = offsets.data() + k;
      section.texels.push_back({offset[0], offset[1], offset[2]});
    }
    section.coefficients = numbers_of(coefficients);
    section.errors = numbers_of(errors);
    section.trilinear_errors = numbers_of(trilinear_errors);
    section.gaps = numbers_of(gaps);
  }
  check_table(table);
  return table;
}

SectionArrays bound_section(const SamplingTable& table, int levels) {
  const TableSection& section = table.section(levels);
  const py::ssize_t texels = table.shape.texels;
  const py::ssize_t subdomains = static_cast<py::ssize_t>(section.texels.size()) / texels;
  Array<int> offsets({subdomains, texels, py::ssize_t{3}});
  int* offset = offsets.mutable_data();
  for (const TexelOffset& texel : section.texels) {
    *offset++ = texel.finer;
    *offset++ = texel.x;
    *offset++ = texel.y;
  }
  const auto count = [](const std::vector<double>& values) {
    return static_cast<py::ssize_t>(values.size());
  };
  return {std::move(offsets),
          to_array<double>(section.coefficients, {subdomains, texels, table.shape.terms()}),
          to_array<double>(section.errors, {count(section.errors)}),
          to_array<double>(section.trilinear_errors, {count(section.trilinear_errors)}),
          to_array<double>(section.gaps, {count(section.gaps)})};
}

}  // namespace

void bind_sampling_table(py::module_& m) {
  bind_table_shape(m);
  py::class_<SamplingTable>(m, "SamplingTable")
      .def(py::init(&bound_make), py::arg("shape"), py::arg("sections"))
      .def_readonly("shape", &SamplingTable::shape)
      .def("section", &bound_section, py::arg("levels"))
      .def(
          "error_ratio",
          [](const SamplingTable& table, int levels) { return error_ratio(table.section(levels)); },
          py::arg("levels"))
      .def("largest_jump", &largest_jump, py::arg("levels"),
           py::call_guard<py::gil_scoped_release>());
  m.def("build_sampling_table", &bound_build, py::arg("shape"), py::arg("certify"),
        py::arg("progress"), py::arg("threads"));
}

}  // namespace prefilter::python
