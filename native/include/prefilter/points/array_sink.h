// SPDX-License-Identifier: GPL-3.0-or-later

// A mesh sink in memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/points/mesh_sink.h"

namespace prefilter {

/// Collects a mesh in arrays.
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
  // Frees each piece as soon as it is copied, so that little is in memory twice.
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
