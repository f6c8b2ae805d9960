// SPDX-License-Identifier: GPL-3.0-or-later

#include <pybind11/pybind11.h>

#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "convert.h"
#include "prefilter/base/error.h"
#include "prefilter/base/memory.h"
#include "prefilter/base/names.h"
#include "prefilter/base/random_name.h"

namespace py = pybind11;

namespace prefilter::python {

void bind_blocks(py::module_& m);
void bind_exr(py::module_& m);
void bind_cloud(py::module_& m);
void bind_color(py::module_& m);
void bind_contour(py::module_& m);
void bind_cutout(py::module_& m);
void bind_elementary(py::module_& m);
void bind_mipmap(py::module_& m);
void bind_normals(py::module_& m);
void bind_raster(py::module_& m);
void bind_reconstruct(py::module_& m);
void bind_resample(py::module_& m);
void bind_resize(py::module_& m);
void bind_sampling(py::module_& m);
void bind_sampling_table(py::module_& m);
void bind_scan(py::module_& m);
void bind_solid(py::module_& m);
void bind_spatial(py::module_& m);
void bind_surface(py::module_& m);
void bind_views(py::module_& m);
void bind_voxel(py::module_& m);

ImageView view_of(const Array<float>& array) {
  return {array.data(), static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)),
          static_cast<int>(array.shape(2))};
}

namespace {

template <typename Narrow, typename Wide>
RowView<Narrow, Wide> row_view(const py::array& array) {
  const auto count = static_cast<std::size_t>(array.shape(0));
  if (array.itemsize() == static_cast<py::ssize_t>(sizeof(Narrow))) {
    return std::span(static_cast<const std::array<Narrow, 3>*>(array.data()), count);
  }
  return std::span(static_cast<const std::array<Wide, 3>*>(array.data()), count);
}

}  // namespace

InputMesh mesh_of(const py::array& positions, const py::array& triangles) {
  return {row_view<float, double>(positions), row_view<std::int32_t, std::int64_t>(triangles)};
}

std::vector<ImageView> views_of(const std::vector<Array<float>>& arrays) {
  std::vector<ImageView> views;
  for (const Array<float>& array : arrays) views.push_back(view_of(array));
  return views;
}

Array<float> to_array(Image image) {
  auto owner = std::make_unique<Image>(std::move(image));
  const Image& held = *owner;
  const py::capsule capsule(owner.release(),
                            [](void* pointer) { delete static_cast<Image*>(pointer); });
  return Array<float>({held.height, held.width, held.channels}, held.data.data(), capsule);
}

std::vector<Array<float>> to_arrays(std::vector<Image> images) {
  std::vector<Array<float>> arrays;
  for (Image& image : images) arrays.push_back(to_array(std::move(image)));
  return arrays;
}

WrapModes wrap_modes(const WrapNames& names) {
  return {value_named("wrap", names.first, kWraps), value_named("wrap", names.second, kWraps)};
}

bool is_finalizing() {
#if PY_VERSION_HEX >= 0x030D0000
  return Py_IsFinalizing() != 0;
#else
  return _Py_IsFinalizing() != 0;
#endif
}

Run to_run(const py::object& callback, int threads) {
  return Run(threads, [callback = py::handle(callback)](double fraction) {
    if (is_finalizing()) return false;
    const py::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (callback.is_none()) return true;
    return !callback(fraction).is(py::bool_(false));
  });
}

}  // namespace prefilter::python

namespace {
// File names in messages may contain any bytes.
void set_error(PyObject* type, const char* message) {
  const auto length = static_cast<Py_ssize_t>(std::strlen(message));
  PyObject* const text = PyUnicode_DecodeUTF8(message, length, "backslashreplace");
  if (text == nullptr) return;
  PyErr_SetObject(type, text);
  Py_DECREF(text);
}
}  // namespace

PYBIND11_MODULE(_native, m) {
  using prefilter::Error;
  using prefilter::ErrorCode;
  m.attr("VERSION") = PREFILTER_VERSION;
  m.def(
      "available_memory",
      [] {
        const std::uint64_t bytes = prefilter::available_memory();
        return bytes == std::numeric_limits<std::uint64_t>::max()
                   ? std::numeric_limits<double>::infinity()
                   : static_cast<double>(bytes);
      },
      "Returns the bytes that can be had without driving others out; infinity where unknown.");
  m.def("random_name", &prefilter::random_name,
        "Returns what a file may be called until it is put in place.");
  m.attr("MACHINE_DIGITS") = prefilter::kMachineDigits;
  // Never destroyed: at exit the interpreter may be gone already.
  static auto* const cancelled = new py::exception<Error>(m, "Cancelled");
  cancelled->attr("__module__") = "prefilter";
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::kCancelled) {
        set_error(cancelled->ptr(), error.what());
      } else if (error.code() == ErrorCode::kOutOfMemory) {
        set_error(PyExc_MemoryError, error.what());
      } else if (error.code() == ErrorCode::kFile) {
        set_error(PyExc_OSError, error.what());
      } else {
        set_error(PyExc_ValueError, error.what());
      }
    }
  });
  prefilter::python::bind_blocks(m);
  prefilter::python::bind_exr(m);
  prefilter::python::bind_cloud(m);
  prefilter::python::bind_color(m);
  prefilter::python::bind_cutout(m);
  prefilter::python::bind_elementary(m);
  prefilter::python::bind_normals(m);
  prefilter::python::bind_scan(m);
  prefilter::python::bind_solid(m);
  prefilter::python::bind_spatial(m);
  prefilter::python::bind_surface(m);
  prefilter::python::bind_mipmap(m);
  prefilter::python::bind_views(m);
  prefilter::python::bind_voxel(m);
  prefilter::python::bind_contour(m);
  prefilter::python::bind_reconstruct(m);
  prefilter::python::bind_raster(m);
  prefilter::python::bind_sampling(m);
  prefilter::python::bind_resample(m);
  prefilter::python::bind_resize(m);
  prefilter::python::bind_sampling_table(m);
}
