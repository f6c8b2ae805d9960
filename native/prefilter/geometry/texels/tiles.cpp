// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/texels/tiles.h"

#include <array>
#include <utility>

namespace prefilter {
namespace {

struct TileRange {
  int first, last;
};

TileRange tile_range(double a, double b, double c, int count) {
  const CellSpan span =
      cell_span(std::min({a, b, c}) / Tiles::kSize, std::max({a, b, c}) / Tiles::kSize);
  return {std::min(span.first, count - 1), std::min(span.last, count - 1)};
}

template <typename Use>
void for_each_tile(const MassTriangle& triangle, int columns, int rows, const Use& use) {
  const std::array<GridPoint, 3>& p = triangle.corners;
  const TileRange x = tile_range(p[0].x, p[1].x, p[2].x, columns);
  const TileRange y = tile_range(p[0].y, p[1].y, p[2].y, rows);
  for (int row = y.first; row <= y.last; ++row) {
    for (int column = x.first; column <= x.last; ++column) {
      use(static_cast<std::int64_t>(row) * columns + column);
    }
  }
}

}  // namespace

// Colors alternate between 0 and 1. The last tile is next to the first around the edge, and may be
// so narrow that the tile before it comes close to the first too; these two get their own colors.
int tile_color(int tile, int count, int size) {
  const bool narrow = size % Tiles::kSize != 0;
  if (count > 1 && tile == count - 1 && (narrow || count % 2 == 1)) return 2;
  if (count > 2 && tile == count - 2 && narrow) return 3;
  return tile % 2;
}

Tiles::Tiles(const TexelTriangles& triangles, const Run& run)
    : width_(triangles.width),
      height_(triangles.height),
      columns_((triangles.width + kSize - 1) / kSize),
      rows_((triangles.height + kSize - 1) / kSize) {
  // Two passes over runs of triangles: the first counts each batch's entries per tile, the second
  // writes them to their final positions.
  constexpr std::size_t kBatches = 16;
  const std::size_t size = triangles.triangles.size();
  const auto batch_first = [size](std::int64_t batch) { return size * batch / kBatches; };
  const auto for_each_member = [&](const Run& part, const auto& use) {
    parallel_for(kBatches, part, [&](std::int64_t batch) {
      for (std::size_t k = batch_first(batch); k < batch_first(batch + 1); ++k) {
        for_each_tile(triangles.triangles[k], columns_, rows_,
                      [&](std::int64_t tile) { use(batch, tile, k); });
      }
    });
  };
  std::array<std::vector<std::int64_t>, kBatches> next;
  next.fill(std::vector<std::int64_t>(static_cast<std::size_t>(count())));
  const Stages stages(run, {1, 1});
  for_each_member(stages[0],
                  [&](std::int64_t batch, std::int64_t tile, std::size_t) { ++next[batch][tile]; });
  std::int64_t total = 0;
  for (std::int64_t tile = 0; tile < count(); ++tile) {
    starts_.push_back(total);
    for (std::vector<std::int64_t>& batch : next) total += std::exchange(batch[tile], total);
  }
  starts_.push_back(total);
  members_.resize(static_cast<std::size_t>(total));
  for_each_member(stages[1], [&](std::int64_t batch, std::int64_t tile, std::size_t k) {
    members_[next[batch][tile]++] = static_cast<std::uint32_t>(k);
  });
}

CellWindow Tiles::window(std::int64_t tile) const {
  const int x0 = static_cast<int>(tile % columns_) * kSize;
  const int y0 = static_cast<int>(tile / columns_) * kSize;
  return {x0, y0, std::min(x0 + kSize, width_), std::min(y0 + kSize, height_)};
}

void Tiles::for_each_apart(const Run& run, const std::function<void(std::int64_t)>& body) const {
  std::int64_t done = 0;
  for (int pass = 0; pass < kTileColors * kTileColors; ++pass) {
    std::vector<std::int64_t> members;
    for (int row = 0; row < rows_; ++row) {
      if (tile_color(row, rows_, height_) != pass / kTileColors) continue;
      for (int column = 0; column < columns_; ++column) {
        if (tile_color(column, columns_, width_) != pass % kTileColors) continue;
        members.push_back(static_cast<std::int64_t>(row) * columns_ + column);
      }
    }
    if (members.empty()) continue;
    const auto size = static_cast<std::int64_t>(members.size());
    const double total = static_cast<double>(count());
    parallel_for(
        size, run.part(static_cast<double>(done) / total, static_cast<double>(done + size) / total),
        [&](std::int64_t i) { body(members[i]); });
    done += size;
  }
}

}  // namespace prefilter
