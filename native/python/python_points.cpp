// SPDX-License-Identifier: GPL-3.0-or-later

#include "python_points.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "convert.h"

namespace py = pybind11;

namespace prefilter::python {
namespace {

// Positions, normals, weights, viewpoints and attributes of a chunk of points.
using Chunk = std::tuple<Array<double>, std::optional<Array<float>>, std::optional<Array<float>>,
                         std::optional<Array<double>>, Array<float>>;

// Objects that may only be changed or released with the interpreter's lock.
struct LockedObjects {
  py::object reader;
  py::object iterator;
  std::optional<Chunk> chunk;
};

// Throws an error if an array has another size than the reader announced.
template <typename T>
const T* checked_rows(const Array<T>& array, std::size_t count, std::size_t width,
                      std::size_t first) {
  if (static_cast<std::size_t>(array.size()) != count * width) {
    throw py::value_error("reader: arrays of a chunk have different lengths");
  }
  return array.data() + first * width;
}

class PythonPoints final : public PointSource {
 public:
  explicit PythonPoints(const py::object& reader)
      : count_(reader.attr("count").cast<std::optional<std::size_t>>()),
        viewpoint_(reader.attr("viewpoint").cast<std::optional<Vector3>>()),
        has_normals_(reader.attr("has_normals").cast<bool>()),
        can_seek_(reader.attr("can_seek").cast<bool>()) {
    for (auto& [name, is_byte] :
         reader.attr("attributes").cast<std::vector<std::pair<std::string, bool>>>()) {
      attributes_.push_back({std::move(name), is_byte});
    }
    objects_ = std::make_unique<LockedObjects>(LockedObjects{reader, py::object(), std::nullopt});
  }

  ~PythonPoints() override {
    if (is_finalizing()) {
      (void)objects_.release();
      return;
    }
    const py::gil_scoped_acquire locked;
    objects_.reset();
  }

  std::optional<std::size_t> count() const override {
    return chosen_ ? chosen_->second - chosen_->first : count_;
  }
  bool has_normals() const override { return has_normals_; }
  const std::vector<PointAttribute>& attributes() const override { return attributes_; }
  std::optional<Vector3> viewpoint() const override { return viewpoint_; }
  // These formats store coordinates as scaled integers or doubles.
  bool is_double() const override { return true; }
  std::optional<std::size_t> rows() const override { return can_seek_ ? count_ : std::nullopt; }
  void choose_rows(std::size_t begin, std::size_t end) override {
    chosen_ = {begin, end};
    rewind();
  }

  void rewind() override {
    const py::gil_scoped_acquire locked;
    objects_->iterator = py::object();
    objects_->chunk.reset();
  }

  bool read(std::size_t most, PointBatch* batch) override {
    const py::gil_scoped_acquire locked;
    batch->clear();
    if (!objects_->iterator) objects_->iterator = chunks();
    while (!objects_->chunk || done_ == size_) {
      PyObject* const next = PyIter_Next(objects_->iterator.ptr());
      if (next == nullptr) {
        if (PyErr_Occurred() != nullptr) throw py::error_already_set();
        objects_->chunk.reset();
        return false;
      }
      objects_->chunk = py::reinterpret_steal<py::object>(next).cast<Chunk>();
      size_ = static_cast<std::size_t>(std::get<0>(*objects_->chunk).shape(0));
      done_ = 0;
    }
    take(std::min(most, size_ - done_), batch);
    return true;
  }

 private:
  py::object chunks() const {
    const py::object all = objects_->reader.attr("chunks");
    return chosen_ ? all(chosen_->first, chosen_->second) : all();
  }

  template <typename T>
  void append(const Array<T>& array, std::size_t count, std::vector<std::array<T, 3>>* to) const {
    const T* const row = checked_rows(array, size_, 3, done_);
    for (std::size_t i = 0; i < count; ++i) {
      to->push_back({row[3 * i], row[3 * i + 1], row[3 * i + 2]});
    }
  }

  void take(std::size_t count, PointBatch* batch) {
    const auto& [positions, normals, weights, viewpoints, attributes] = *objects_->chunk;
    append(positions, count, &batch->positions);
    if (has_normals_ && normals) append(*normals, count, &batch->normals);
    if (viewpoints) append(*viewpoints, count, &batch->viewpoints);
    if (weights) {
      const float* const weight = checked_rows(*weights, size_, 1, done_);
      batch->weights.assign(weight, weight + count);
    }
    const float* const values = checked_rows(attributes, size_, attributes_.size(), done_);
    batch->attributes.assign(values, values + count * attributes_.size());
    done_ += count;
  }

  std::unique_ptr<LockedObjects> objects_;
  std::optional<std::size_t> count_;
  std::optional<Vector3> viewpoint_;
  std::vector<PointAttribute> attributes_;
  bool has_normals_;
  bool can_seek_;
  std::optional<std::pair<std::size_t, std::size_t>> chosen_;  // rows
  std::size_t size_ = 0;                                       // of the chunk
  std::size_t done_ = 0;                                       // points read from the chunk
};

}  // namespace

std::unique_ptr<PointSource> make_python_points(const py::object& reader) {
  return std::make_unique<PythonPoints>(reader);
}

}  // namespace prefilter::python
