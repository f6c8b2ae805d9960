// SPDX-License-Identifier: GPL-3.0-or-later

// Points, boxes and triangle meshes in space.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "prefilter/base/elementary.h"

namespace prefilter {

/// The difference of any two coordinates has to be finite as well.
inline constexpr double kLargestCoordinate = 1e300;

/// A point or a direction.
using Vector3 = std::array<double, 3>;

inline Vector3 operator+(const Vector3& a, const Vector3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vector3 operator-(const Vector3& a, const Vector3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vector3 operator*(double factor, const Vector3& a) {
  return {factor * a[0], factor * a[1], factor * a[2]};
}
inline double dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// Neither overflows nor underflows on the way.
inline double length(const Vector3& a) { return elementary::hypot(a[0], a[1], a[2]); }
/// The same where squares of the coordinates neither overflow nor underflow, and quicker.
inline double plain_length(const Vector3& a) { return std::sqrt(dot(a, a)); }

/// A box along the axes.
struct Box {
  Vector3 low{};
  Vector3 high{};

  double size(int axis) const { return high[axis] - low[axis]; }
  double volume() const { return size(0) * size(1) * size(2); }

  void include(const Vector3& point) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], point[a]);
      high[a] = std::max(high[a], point[a]);
    }
  }
  void include(const Box& other) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], other.low[a]);
      high[a] = std::max(high[a], other.high[a]);
    }
  }
  /// Whether the boxes have a point in common.
  bool overlaps(const Box& other) const {
    for (int a = 0; a < 3; ++a) {
      if (low[a] > other.high[a] || high[a] < other.low[a]) return false;
    }
    return true;
  }
  double squared_distance(const Vector3& point) const {
    double sum = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double outside = std::max({low[a] - point[a], point[a] - high[a], 0.0});
      sum += outside * outside;
    }
    return sum;
  }
};

/// The box that holds nothing: what it includes first becomes the box.
inline constexpr Box kEmptyBox = {
    {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
     std::numeric_limits<double>::infinity()},
    {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
     -std::numeric_limits<double>::infinity()}};

/// Triangles that share vertices, as someone else holds them; counter-clockwise seen from outside.
template <typename Index>
struct MeshView {
  std::span<const Vector3> positions;
  std::span<const std::array<Index, 3>> triangles;

  std::array<Vector3, 3> corners(std::size_t triangle) const {
    const auto& [a, b, c] = triangles[triangle];
    return {positions[static_cast<std::size_t>(a)], positions[static_cast<std::size_t>(b)],
            positions[static_cast<std::size_t>(c)]};
  }
};

/// Rows of three numbers as someone else holds them, in one of two types; they are read as the
/// wider.
template <typename Narrow, typename Wide>
class RowView {
 public:
  using Row = std::array<Wide, 3>;

  RowView() = default;
  RowView(std::span<const std::array<Narrow, 3>> rows)  // NOLINT(google-explicit-constructor)
      : narrow_(rows.data()), size_(rows.size()) {}
  RowView(std::span<const Row> rows)  // NOLINT(google-explicit-constructor)
      : wide_(rows.data()), size_(rows.size()) {}
  template <typename Rows>
  requires std::convertible_to<const Rows&, std::span<const std::array<Narrow, 3>>> RowView(
      const Rows& rows)  // NOLINT(google-explicit-constructor)
      : RowView(std::span<const std::array<Narrow, 3>>(rows)) {}
  template <typename Rows>
  requires std::convertible_to<const Rows&, std::span<const Row>> RowView(
      const Rows& rows)  // NOLINT(google-explicit-constructor)
      : RowView(std::span<const Row>(rows)) {}

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  Row operator[](std::size_t i) const {
    if (wide_ != nullptr) return wide_[i];
    const auto& [a, b, c] = narrow_[i];
    return {static_cast<Wide>(a), static_cast<Wide>(b), static_cast<Wide>(c)};
  }

  class Iterator {
   public:
    Iterator(const RowView* rows, std::size_t at) : rows_(rows), at_(at) {}
    Row operator*() const { return (*rows_)[at_]; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const RowView* rows_;
    std::size_t at_;
  };
  Iterator begin() const { return {this, 0}; }
  Iterator end() const { return {this, size_}; }

 private:
  const std::array<Narrow, 3>* narrow_ = nullptr;
  const Row* wide_ = nullptr;
  std::size_t size_ = 0;
};

using PositionView = RowView<float, double>;
using TriangleView = RowView<std::int32_t, std::int64_t>;

/// A mesh as callers pass it; counter-clockwise seen from outside. Its indices are not yet known to
/// name vertices.
struct InputMesh {
  PositionView positions;
  TriangleView triangles;

  std::array<Vector3, 3> corners(std::size_t triangle) const {
    const auto [a, b, c] = triangles[triangle];
    return {positions[static_cast<std::size_t>(a)], positions[static_cast<std::size_t>(b)],
            positions[static_cast<std::size_t>(c)]};
  }
};

/// Triangles that share vertices; counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

/// Throws Error where a row holds a value that is not finite, or larger than `largest`. `rows` says
/// what they are: "points: row".
void check_points(const PositionView& points, const char* rows, double largest);

/// Throws Error where an index names none of `count` vertices; `who` names it.
[[noreturn]] void throw_no_vertex(const std::string& who, std::int64_t vertex, std::size_t count);

/// Throws Error for a mesh without triangles, or with more than the library counts (2^31 - 1
/// vertices, 2^32 - 1 triangles); an index that names no vertex; a position as check_points says.
void check_mesh(const InputMesh& mesh, double largest);

/// Throws Error, with the name of the argument, where a box has no volume, is not finite, or is so
/// thin for its distance from the origin that its finest cells have no volume.
void check_box(const Box& box, const char* argument);

}  // namespace prefilter
