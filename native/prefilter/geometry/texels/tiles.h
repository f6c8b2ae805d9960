// SPDX-License-Identifier: GPL-3.0-or-later

// Square tiles of an image, with the triangles near each tile.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/geometry/texels/texel_triangles.h"

namespace prefilter {

/// The color of tile `tile` of `count` along an axis of `size` texels, below kTileColors. Tiles of
/// one color are at least a tile apart, even around the edge.
inline constexpr int kTileColors = 4;
int tile_color(int tile, int count, int size);

/// Tiles of up to kSize x kSize texels, in row-major order. The triangles of each tile are in mesh
/// order.
class Tiles {
 public:
  // The half-texel moments of a tile take 64 * 64 * 80 bytes, which fit in a second-level cache.
  static constexpr int kSize = 32;

  Tiles(const TexelTriangles& triangles, const Run& run);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  std::int64_t count() const { return static_cast<std::int64_t>(columns_) * rows_; }

  /// The texel range of a tile.
  CellWindow window(std::int64_t tile) const;

  /// Indices of the triangles whose bounding boxes intersect a tile: [begin, end).
  const std::uint32_t* begin(std::int64_t tile) const { return members_.data() + starts_[tile]; }
  const std::uint32_t* end(std::int64_t tile) const { return members_.data() + starts_[tile + 1]; }

  /// Calls body(tile) for all tiles in parallel, in passes. No two tiles of a pass are neighbors,
  /// not even around the image's edges.
  void for_each_apart(const Run& run, const std::function<void(std::int64_t)>& body) const;

 private:
  int width_;
  int height_;
  int columns_;
  int rows_;
  std::vector<std::int64_t> starts_;
  std::vector<std::uint32_t> members_;
};

}  // namespace prefilter
