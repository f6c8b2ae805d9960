// SPDX-License-Identifier: GPL-3.0-or-later

// Square tiles of an image, each with the triangles that may meet it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/textures/texels/texel_triangles.h"

namespace prefilter {

/// Numbers of tiles along an axis, colored so that those of one color are a whole tile apart,
/// even around the edge.
inline constexpr int kTileColors = 4;
int tile_color(int tile, int count, int size);

/// Tiles of up to kSize x kSize texels, in rows, with the triangles of each in the order of the
/// mesh.
class Tiles {
 public:
  // Half-texel moments of one tile take 64 * 64 * 80 bytes, which a second-level cache holds.
  static constexpr int kSize = 32;

  Tiles(const TexelTriangles& triangles, const Progress& progress, int threads);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  std::int64_t count() const { return static_cast<std::int64_t>(columns_) * rows_; }

  /// The texels of a tile.
  CellWindow window(std::int64_t tile) const;

  /// The indices of the triangles whose bounding boxes meet a tile: [begin, end).
  const std::uint32_t* begin(std::int64_t tile) const { return members_.data() + starts_[tile]; }
  const std::uint32_t* end(std::int64_t tile) const { return members_.data() + starts_[tile + 1]; }

  /// Calls body(tile) for all tiles in parallel, in passes: tiles of one pass are not neighbors,
  /// not even around the image's edges.
  void for_each_apart(int threads, const Progress& progress,
                      const std::function<void(std::int64_t)>& body) const;

 private:
  int width_;
  int height_;
  int columns_;
  int rows_;
  std::vector<std::int64_t> starts_;
  std::vector<std::uint32_t> members_;
};

}  // namespace prefilter
