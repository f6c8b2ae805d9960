// SPDX-License-Identifier: GPL-3.0-or-later

// Points from arrays.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// Rows of three floats or doubles, owned by the caller.
using VectorRows =
    std::variant<std::span<const std::array<float, 3>>, std::span<const std::array<double, 3>>>;

/// A point source over arrays, which must outlive it.
class ArraySource : public PointSource {
 public:
  /// `weights` may be empty; `attributes` has one row per point. See PointSource for `is_double`.
  ArraySource(VectorRows positions, VectorRows normals, std::span<const float> weights,
              std::span<const float> attributes, std::vector<PointAttribute> names,
              bool is_double = false)
      : positions_(positions),
        normals_(normals),
        weights_(weights),
        attributes_(attributes),
        names_(std::move(names)),
        is_double_(is_double),
        end_(size()) {}

  std::optional<std::size_t> count() const override { return end_ - begin_; }
  bool has_normals() const override { return true; }
  const std::vector<PointAttribute>& attributes() const override { return names_; }
  bool is_double() const override { return is_double_; }
  std::optional<std::size_t> rows() const override { return size(); }
  void choose_rows(std::size_t begin, std::size_t end) override {
    next_ = begin_ = begin;
    end_ = end;
  }
  void rewind() override { next_ = begin_; }

  bool read(std::size_t most, PointBatch* batch) override {
    const std::size_t n = std::min(most, end_ - next_);
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
  std::size_t size() const {
    return std::visit([](const auto& rows) { return rows.size(); }, positions_);
  }

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
  bool is_double_;
  std::size_t begin_ = 0;
  std::size_t end_;
  std::size_t next_ = 0;
};

}  // namespace prefilter
