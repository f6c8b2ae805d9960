// SPDX-License-Identifier: GPL-3.0-or-later

// Points read by Python code, for formats whose libraries are Python modules.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "prefilter/points/point_source.h"

namespace prefilter::python {

/// A source of the points that a Python `PointReader` reads.
std::unique_ptr<PointSource> make_python_points(const pybind11::object& reader);

}  // namespace prefilter::python
