// SPDX-License-Identifier: GPL-3.0-or-later

// Passes instances of the module's classes to C++ only after their __init__ has run.
//
// Python can create an object without it (Class.__new__(Class)), for which pybind11 would pass
// uninitialized memory. Every file that binds functions of these classes must include this header.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <utility>

#include "prefilter/base/outline.h"
#include "prefilter/geometry/nearest.h"
#include "prefilter/geometry/surface.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/sampling/sampling_table.h"
#include "prefilter/shapes/paint.h"
#include "prefilter/voxels/octree.h"

namespace prefilter::python {

/// Throws TypeError for an object whose __init__ has not run.
template <typename T>
class InstanceCaster : public pybind11::detail::type_caster_base<T> {
 public:
  bool load(pybind11::handle source, bool convert) {
    return this->template load_impl<InstanceCaster<T>>(source, convert);
  }

  // Called by load_impl.
  void load_value(pybind11::detail::value_and_holder&& instance) {
    if (!instance.holder_constructed()) {
      throw pybind11::type_error(std::string(this->typeinfo->type->tp_name) +
                                 ": an object whose __init__ has not run holds nothing");
    }
    pybind11::detail::type_caster_base<T>::load_value(std::move(instance));
  }
};

}  // namespace prefilter::python

template <>
class pybind11::detail::type_caster<prefilter::NearestPoints>
    : public prefilter::python::InstanceCaster<prefilter::NearestPoints> {};

template <>
class pybind11::detail::type_caster<prefilter::Octree>
    : public prefilter::python::InstanceCaster<prefilter::Octree> {};

template <>
class pybind11::detail::type_caster<prefilter::Outline>
    : public prefilter::python::InstanceCaster<prefilter::Outline> {};

template <>
class pybind11::detail::type_caster<prefilter::Paint>
    : public prefilter::python::InstanceCaster<prefilter::Paint> {};

template <>
class pybind11::detail::type_caster<prefilter::PointSource>
    : public prefilter::python::InstanceCaster<prefilter::PointSource> {};

template <>
class pybind11::detail::type_caster<prefilter::SamplingTable>
    : public prefilter::python::InstanceCaster<prefilter::SamplingTable> {};

template <>
class pybind11::detail::type_caster<prefilter::Surface>
    : public prefilter::python::InstanceCaster<prefilter::Surface> {};

template <>
class pybind11::detail::type_caster<prefilter::ReconstructOptions>
    : public prefilter::python::InstanceCaster<prefilter::ReconstructOptions> {};
