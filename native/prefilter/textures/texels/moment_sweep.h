// SPDX-License-Identifier: GPL-3.0-or-later

// The moment pyramid: one pass over the mesh that computes, for every level, the moments of the
// surface and of the image on it.
//
// On a cell of level l the bilinear basis functions of level l and of all coarser levels are
// bilinear polynomials (figure 7.4, and level_grid.h). A cell of level l + 1 is a block of cells of
// level l, so its moments are a fixed linear combination of theirs: the mesh is cut only once,
// along the finest cells. The image is processed in tiles that fit in a processor's cache; the
// moments of the finest cells are not stored.
#pragma once

#include <functional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/geometry/moments/cell_moments.h"
#include "prefilter/geometry/texels/texel_triangles.h"
#include "prefilter/textures/reader.h"
#include "prefilter/textures/texels/level_grid.h"

namespace prefilter {

/// The cells [x0, x0 + width) x [y0, y0 + height) of a level.
template <int C>
struct MomentBlock {
  int level = 0;
  int x0 = 0;
  int y0 = 0;
  int width = 0;
  int height = 0;
  const CellMoments<C>* cells = nullptr;  // row-major
  // Image moments of SweepOptions::means, row-major; on levels 0 and 1 only.
  const ChannelMoments<C>* means = nullptr;
  const AxisCells* x_cells = nullptr;
  const AxisCells* y_cells = nullptr;
  std::int64_t index = 0;  // of the tile; blocks of a whole coarse level have the last index

  const CellMoments<C>& at(int x, int y) const { return cells[index_of(x, y)]; }
  const ChannelMoments<C>& means_at(int x, int y) const { return means[index_of(x, y)]; }
  std::ptrdiff_t index_of(int x, int y) const { return static_cast<std::ptrdiff_t>(y) * width + x; }
  /// Positions of the block's columns and rows between texel centers of this level or the next.
  const CellPlace* x_places(int of) const { return x_cells->places(level, of).data() + x0; }
  const CellPlace* y_places(int of) const { return y_cells->places(level, of).data() + y0; }
};

/// Calls use(x, x_end, y, y_end) for each range of cells between the same four texel centers of the
/// block's level.
template <int C, typename Use>
void for_each_dual_range(const MomentBlock<C>& block, const Use& use) {
  const CellPlace* x_places = block.x_places(block.level);
  const CellPlace* y_places = block.y_places(block.level);
  const auto run_end = [](const CellPlace* places, int begin, int end) {
    int i = begin + 1;
    while (i < end && places[i].texel == places[begin].texel) ++i;
    return i;
  };
  for (int y_begin = 0; y_begin < block.height;) {
    const int y_end = run_end(y_places, y_begin, block.height);
    for (int x_begin = 0; x_begin < block.width;) {
      const int x_end = run_end(x_places, x_begin, block.width);
      use(x_begin, x_end, y_begin, y_end);
      x_begin = x_end;
    }
    y_begin = y_end;
  }
}

/// For each dual cell, between the texel centers (column, row) and (column + 1, row + 1) of the
/// block's level, that the block's surface reaches: calls use(moments, column, row) with the
/// moments of the surface in it, in the coordinates of the dual cell.
template <int C, typename Use>
void for_each_dual_cell(const MomentBlock<C>& block, const Use& use) {
  const CellPlace* x_places = block.x_places(block.level);
  const CellPlace* y_places = block.y_places(block.level);
  for_each_dual_range(block, [&](int x_begin, int x_end, int y_begin, int y_end) {
    CellMoments<C> moments;
    for (int y = y_begin; y < y_end; ++y) {
      for (int x = x_begin; x < x_end; ++x) {
        const CellMoments<C>& cell = block.at(x, y);
        if (cell.empty()) continue;
        add_child(cell, x_places[x].placement, y_places[y].placement, &moments);
      }
    }
    if (!moments.empty()) use(moments, x_places[x_begin].texel, y_places[y_begin].texel);
  });
}

/// The same for the image moments of the means. The block must have them.
template <int C, typename Use>
void for_each_dual_cell_of_means(const MomentBlock<C>& block, const Use& use) {
  const CellPlace* x_places = block.x_places(block.level);
  const CellPlace* y_places = block.y_places(block.level);
  for_each_dual_range(block, [&](int x_begin, int x_end, int y_begin, int y_end) {
    ChannelMoments<C> moments{};
    bool is_empty = true;
    for (int y = y_begin; y < y_end; ++y) {
      for (int x = x_begin; x < x_end; ++x) {
        if (block.at(x, y).empty()) continue;
        is_empty = false;
        add_image_child(block.means_at(x, y), x_places[x].placement, y_places[y].placement,
                        &moments);
      }
    }
    if (!is_empty) use(moments, x_places[x_begin].texel, y_places[y_begin].texel);
  });
}

struct SweepOptions {
  int first_level = 1;  // 0 or 1: the finest level that is visited
  int last_level = 1;
  // For kSrgbAfter the image has encoded colors, and the moments of its decoded lookups are
  // computed by FourPointRule in each of the finest cells.
  Reader reader = Reader::kLinear;
  // Another image of the same size and channels, whose moments are returned in MomentBlock::means;
  // not supported with kSrgbAfter.
  const Image* means = nullptr;
};

/// Number of different values of MomentBlock::index.
std::int64_t sweep_block_count(int width, int height);

/// Visits every cell of the requested levels, block by block. Blocks are visited concurrently only
/// if their cells, including neighboring texels of their level, are disjoint; any other two blocks
/// are visited in the same order for every number of threads. `image` must be finite and have C
/// channels.
template <int C>
void sweep_moments(const TexelTriangles& triangles, const TexelSource& image, WrapModes wrap,
                   const SweepOptions& options, const Run& run,
                   const std::function<void(const MomentBlock<C>&)>& visit);

}  // namespace prefilter
