// SPDX-License-Identifier: GPL-3.0-or-later

#include <vector>

#include "convert.h"
#include "prefilter/base/elementary.h"

namespace py = pybind11;

namespace prefilter::python {

// The functions of Python's math module and of NumPy differ between systems and processors.
void bind_elementary(py::module_& m) {
  m.def("atan2", elementary::atan2, py::arg("y"), py::arg("x"));
  m.def("cos", elementary::cos, py::arg("x"));
  m.def(
      "hypot", [](double x, double y) { return elementary::hypot(x, y); }, py::arg("x"),
      py::arg("y"));
  m.def("sin", elementary::sin, py::arg("x"));
  m.def("tan", elementary::tan, py::arg("x"));
  m.def(
      "powers",
      [](const Array<double>& values, double exponent) {
        Array<double> powers(
            std::vector<py::ssize_t>(values.shape(), values.shape() + values.ndim()));
        const double* from = values.data();
        double* to = powers.mutable_data();
        const py::ssize_t count = values.size();
        const py::gil_scoped_release unlocked;
        for (py::ssize_t i = 0; i < count; ++i) to[i] = elementary::pow(from[i], exponent);
        return powers;
      },
      py::arg("values"), py::arg("exponent"));
  // Rows of distance, azimuth and elevation, with angles in radians.
  m.def(
      "from_spherical",
      [](const Array<double>& points) {
        const py::ssize_t count = points.shape(0);
        Array<double> positions({count, py::ssize_t{3}});
        const double* from = points.data();
        double* to = positions.mutable_data();
        const py::gil_scoped_release unlocked;
        for (py::ssize_t i = 0; i < count; ++i, from += 3, to += 3) {
          const double flat = from[0] * elementary::cos(from[2]);
          to[0] = flat * elementary::cos(from[1]);
          to[1] = flat * elementary::sin(from[1]);
          to[2] = from[0] * elementary::sin(from[2]);
        }
        return positions;
      },
      py::arg("points"));
}

}  // namespace prefilter::python
