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

/// Differences of two coordinates must be finite as well.
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
/// Does not overflow or underflow internally.
inline double length(const Vector3& a) { return elementary::hypot(a[0], a[1], a[2]); }
/// Faster, but overflows or underflows if squares of the coordinates do.
inline double plain_length(const Vector3& a) { return std::sqrt(dot(a, a)); }

/// An axis-aligned box.
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
  /// Whether the boxes have a common point.
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

/// The empty box; including a first point or box yields exactly that.
inline constexpr Box kEmptyBox = {
    {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
     std::numeric_limits<double>::infinity()},
    {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
     -std::numeric_limits<double>::infinity()}};

/// A view of triangles that share vertices; counterclockwise seen from outside.
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

/// A view of rows of three numbers in one of two types; reads return the wider type.
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

/// A mesh passed by a caller; counterclockwise seen from outside. Indices may be out of range.
struct InputMesh {
  PositionView positions;
  TriangleView triangles;

  std::array<Vector3, 3> corners(std::size_t triangle) const {
    const auto [a, b, c] = triangles[triangle];
    return {positions[static_cast<std::size_t>(a)], positions[static_cast<std::size_t>(b)],
            positions[static_cast<std::size_t>(c)]};
  }
};

/// Triangles that share vertices; counterclockwise seen from outside.
struct TriangleMesh {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

/// Throws Error if a value is not finite or its magnitude is above `largest`. `rows` is the prefix
/// of row numbers in messages, as in "points: row".
void check_points(const PositionView& points, const char* rows, double largest);

/// Throws Error for an index that is out of range for `count` vertices; `who` identifies it.
[[noreturn]] void throw_no_vertex(const std::string& who, std::int64_t vertex, std::size_t count);

/// Throws Error for a mesh without triangles, or with more than the library supports (2^31 - 1
/// vertices, 2^32 - 1 triangles); for an index out of range; and for positions like check_points.
void check_mesh(const InputMesh& mesh, double largest);

/// Throws Error, with the name of the argument, if a box has no volume, is not finite, or is so
/// thin relative to its distance from the origin that its finest cells would have no volume.
void check_box(const Box& box, const char* argument);

}  // namespace prefilter
