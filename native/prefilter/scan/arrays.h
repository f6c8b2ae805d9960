// SPDX-License-Identifier: GPL-3.0-or-later

// Points from arrays, and a mesh into arrays.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/scan/point_source.h"

namespace prefilter {

/// Rows of three floats or doubles, as someone else holds them.
using VectorRows =
    std::variant<std::span<const std::array<float, 3>>, std::span<const std::array<double, 3>>>;

/// Points from arrays, which must outlive it.
class ArraySource : public PointSource {
 public:
  /// `weights` may be empty; `attributes` has a row for each point.
  ArraySource(VectorRows positions, VectorRows normals, std::span<const float> weights,
              std::span<const float> attributes, std::vector<PointAttribute> names)
      : positions_(positions),
        normals_(normals),
        weights_(weights),
        attributes_(attributes),
        names_(std::move(names)) {}

  std::optional<std::size_t> count() const override {
    return std::visit([](const auto& rows) { return rows.size(); }, positions_);
  }
  bool has_normals() const override { return true; }
  const std::vector<PointAttribute>& attributes() const override { return names_; }
  void rewind() override { next_ = 0; }

  bool read(std::size_t most, PointBatch* batch) override {
    const std::size_t n = std::min(most, *count() - next_);
    copy_rows(positions_, n, &batch->positions);
    copy_rows(normals_, n, &batch->normals);
    const auto copy = [&](std::span<const float> values, std::size_t width) {
      const std::span<const float> part =
          values.empty() ? values : values.subspan(next_ * width, n * width);
      return std::vector<float>(part.begin(), part.end());
    };
    batch->weights = copy(weights_, 1);
    batch->attributes = copy(attributes_, names_.size());
    next_ += n;
    return n > 0;
  }

 private:
  template <typename T>
  void copy_rows(const VectorRows& rows, std::size_t n, std::vector<std::array<T, 3>>* to) const {
    to->resize(n);
    std::visit(
        [&](const auto& from) {
          for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t a = 0; a < 3; ++a) (*to)[i][a] = static_cast<T>(from[next_ + i][a]);
          }
        },
        rows);
  }

  VectorRows positions_;
  VectorRows normals_;
  std::span<const float> weights_;
  std::span<const float> attributes_;
  std::vector<PointAttribute> names_;
  std::size_t next_ = 0;
};

/// Keeps a mesh in memory.
class ArraySink : public MeshSink {
 public:
  void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) override {
    vertex_count_ += positions.size();
    positions_.push_back(std::move(positions));
    attributes_.push_back(std::move(attributes));
  }
  /// Throws Error(kOutOfMemory) for more vertices than 2^31.
  void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) override {
    if (vertex_count_ > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
      throw Error(ErrorCode::kOutOfMemory, "the surface has more than 2^31 vertices");
    }
    std::vector<std::array<std::int32_t, 3>>& narrow = triangles_.emplace_back();
    narrow.reserve(triangles.size());
    for (const auto& [a, b, c] : triangles) {
      narrow.push_back({static_cast<std::int32_t>(a), static_cast<std::int32_t>(b),
                        static_cast<std::int32_t>(c)});
    }
  }

  std::vector<Vector3> take_positions() { return joined(&positions_); }
  std::vector<float> take_attributes() { return joined(&attributes_); }
  std::vector<std::array<std::int32_t, 3>> take_triangles() { return joined(&triangles_); }

 private:
  // Each piece goes as soon as it is copied: nothing is in memory twice.
  template <typename T>
  static std::vector<T> joined(std::vector<std::vector<T>>* pieces) {
    std::size_t count = 0;
    for (const std::vector<T>& piece : *pieces) count += piece.size();
    std::vector<T> all;
    all.reserve(count);
    for (std::vector<T>& piece : *pieces) {
      all.insert(all.end(), piece.begin(), piece.end());
      piece = std::vector<T>();
    }
    pieces->clear();
    return all;
  }

  std::vector<std::vector<Vector3>> positions_;
  std::vector<std::vector<float>> attributes_;
  std::vector<std::vector<std::array<std::int32_t, 3>>> triangles_;
  std::size_t vertex_count_ = 0;
};

}  // namespace prefilter
