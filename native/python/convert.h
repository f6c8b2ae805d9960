// What every binding needs: arrays in and out without a copy, and progress.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"

namespace prefilter::python {

/// The Python package passes arrays in just this form.
template <typename T>
using Array = pybind11::array_t<T, pybind11::array::c_style>;

/// A view of an array of shape (height, width, channels).
ImageView view_of(const Array<float>& array);

std::vector<ImageView> views_of(const std::vector<Array<float>>& arrays);

/// An array of shape (height, width, channels) that owns the image.
Array<float> to_array(Image image);
std::vector<Array<float>> to_arrays(std::vector<Image> images);

/// The wrap mode of a public name.
Wrap wrap_mode(const std::string& name);

/// Calls a Python callable, or for None nothing; in both cases lets a keyboard interrupt through.
Progress to_progress(const pybind11::object& callback);

}  // namespace prefilter::python
