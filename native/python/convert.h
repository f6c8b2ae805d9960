// SPDX-License-Identifier: GPL-3.0-or-later

// Conversions shared by all bindings: arrays without copies, and progress.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/image.h"
#include "prefilter/base/names.h"
#include "prefilter/base/rigid_motion.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"

namespace prefilter::python {

/// The form in which the Python package passes arrays.
template <typename T>
using Array = pybind11::array_t<T, pybind11::array::c_style>;

/// A view of an array of shape (height, width, channels).
ImageView view_of(const Array<float>& array);

/// A view of an array of bytes that stand for these values.
inline TexelSource bytes_of(const Array<std::uint8_t>& array, const ByteValues* values) {
  return {array.data(), static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)),
          static_cast<int>(array.shape(2)), values};
}

std::vector<ImageView> views_of(const std::vector<Array<float>>& arrays);

/// An array of shape (height, width, channels) that owns the image.
Array<float> to_array(Image image);
std::vector<Array<float>> to_arrays(std::vector<Image> images);

/// The names in an enumeration's table.
template <typename Value, std::size_t kCount>
pybind11::tuple names_of(const Named<Value> (&table)[kCount]) {
  pybind11::tuple names(kCount);
  for (std::size_t i = 0; i < kCount; ++i) names[i] = pybind11::str(table[i].name);
  return names;
}

/// The rows of an array of shape (rows, 3).
template <typename T>
std::span<const std::array<T, 3>> rows_of(const Array<T>& array) {
  return {reinterpret_cast<const std::array<T, 3>*>(array.data()),
          static_cast<std::size_t>(array.shape(0))};
}

/// The values of a one-dimensional array.
template <typename T>
std::span<const T> values_of(const Array<T>& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// A mesh over C-contiguous arrays: (vertices, 3) of float32 or float64, and (triangles, 3) of
/// int32 or int64. The arrays are not copied and must outlive it. Requires the interpreter's lock.
InputMesh mesh_of(const pybind11::array& positions, const pybind11::array& triangles);

/// The motion given by a matrix of shape (4, 4) or (3, 4).
inline RigidMotion motion_of(const Array<double>& matrix) {
  RigidMotion motion;
  for (pybind11::ssize_t r = 0; r < 3; ++r) {
    const auto row = static_cast<std::size_t>(r);
    motion.rows[row] = {matrix.at(r, 0), matrix.at(r, 1), matrix.at(r, 2)};
    motion.shift[row] = matrix.at(r, 3);
  }
  return motion;
}

/// An array of this shape that owns the values: rows of T, or T themselves.
template <typename T, typename Value>
Array<T> to_array(std::vector<Value> values, std::vector<pybind11::ssize_t> shape) {
  auto owner = std::make_unique<std::vector<Value>>(std::move(values));
  const std::vector<Value>& held = *owner;
  const pybind11::capsule capsule(
      owner.release(), [](void* pointer) { delete static_cast<std::vector<Value>*>(pointer); });
  return Array<T>(std::move(shape), reinterpret_cast<const T*>(held.data()), capsule);
}

/// Wrap modes along u and v by their public names.
using WrapNames = std::pair<std::string, std::string>;
WrapModes wrap_modes(const WrapNames& names);

/// Whether the interpreter is shutting down, and would end any thread that requests its lock.
bool is_finalizing();

/// Reports to a Python callable, or to nothing for None. Raises keyboard interrupts in both cases.
Run to_run(const pybind11::object& callback, int threads = 0);

}  // namespace prefilter::python
