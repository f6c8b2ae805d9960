#include "prefilter/mipmap/tiles.h"

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
  const std::array<Point2, 3>& p = triangle.corners;
  const TileRange x = tile_range(p[0].x, p[1].x, p[2].x, columns);
  const TileRange y = tile_range(p[0].y, p[1].y, p[2].y, rows);
  for (int row = y.first; row <= y.last; ++row) {
    for (int column = x.first; column <= x.last; ++column) {
      use(static_cast<std::int64_t>(row) * columns + column);
    }
  }
}

}  // namespace

// Colours 0 and 1 in turn. The last one is beside the first around the edge, and may be so narrow
// that the one before it comes near the first too: they have colours of their own.
int tile_colour(int tile, int count, int size) {
  const bool narrow = size % Tiles::kSize != 0;
  if (count > 1 && tile == count - 1 && (narrow || count % 2 == 1)) return 2;
  if (count > 2 && tile == count - 2 && narrow) return 3;
  return tile % 2;
}

Tiles::Tiles(const TexelTriangles& triangles, const Progress& progress)
    : width_(triangles.width),
      height_(triangles.height),
      columns_((triangles.width + kSize - 1) / kSize),
      rows_((triangles.height + kSize - 1) / kSize) {
  starts_.assign(static_cast<std::size_t>(count()) + 1, 0);
  const auto size = triangles.triangles.size();
  const Progress counting = progress.part(0.0, 0.5);
  for (std::size_t k = 0; k < size; ++k) {
    for_each_tile(triangles.triangles[k], columns_, rows_,
                  [&](std::int64_t tile) { ++starts_[tile + 1]; });
    counting.report(static_cast<double>(k) / static_cast<double>(size));
  }
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  members_.resize(static_cast<std::size_t>(starts_.back()));
  std::vector<std::int64_t> next(starts_.begin(), starts_.end() - 1);
  const Progress filling = progress.part(0.5, 1.0);
  for (std::size_t k = 0; k < size; ++k) {
    for_each_tile(triangles.triangles[k], columns_, rows_, [&](std::int64_t tile) {
      members_[next[tile]++] = static_cast<std::uint32_t>(k);
    });
    filling.report(static_cast<double>(k) / static_cast<double>(size));
  }
}

CellWindow Tiles::window(std::int64_t tile) const {
  const int x0 = static_cast<int>(tile % columns_) * kSize;
  const int y0 = static_cast<int>(tile / columns_) * kSize;
  return {x0, y0, std::min(x0 + kSize, width_), std::min(y0 + kSize, height_)};
}

void Tiles::for_each_apart(int threads, const Progress& progress,
                           const std::function<void(std::int64_t)>& body) const {
  std::int64_t done = 0;
  for (int pass = 0; pass < kTileColours * kTileColours; ++pass) {
    std::vector<std::int64_t> members;
    for (int row = 0; row < rows_; ++row) {
      if (tile_colour(row, rows_, height_) != pass / kTileColours) continue;
      for (int column = 0; column < columns_; ++column) {
        if (tile_colour(column, columns_, width_) != pass % kTileColours) continue;
        members.push_back(static_cast<std::int64_t>(row) * columns_ + column);
      }
    }
    if (members.empty()) continue;
    const auto size = static_cast<std::int64_t>(members.size());
    const double total = static_cast<double>(count());
    parallel_for(
        size, threads,
        progress.part(static_cast<double>(done) / total, static_cast<double>(done + size) / total),
        [&](std::int64_t i) { body(members[i]); });
    done += size;
  }
}

}  // namespace prefilter
