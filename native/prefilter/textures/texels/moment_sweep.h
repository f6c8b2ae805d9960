// SPDX-License-Identifier: GPL-3.0-or-later

// The moment pyramid: one pass over the mesh that yields, for every level, the moments of the
// surface and of the image on it.
//
// On a cell of level l every bilinear basis function of level l, and of every coarser level, is one
// bilinear polynomial (figure 7.4, and level_grid.h). A cell of level l + 1 is a block of cells of
// level l, so its moments are a fixed combination of theirs: the mesh is cut once, along the finest
// cells. The image is cut into tiles that fit a processor's cache; nothing of the finest cells is
// kept.
#pragma once

#include <functional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/geometry/moments/cell_moments.h"
#include "prefilter/textures/reader.h"
#include "prefilter/textures/texels/level_grid.h"
#include "prefilter/textures/texels/texel_triangles.h"

namespace prefilter {

/// The cells [x0, x0 + width) x [y0, y0 + height) of a level.
template <int C>
struct MomentBlock {
  int level = 0;
  int x0 = 0;
  int y0 = 0;
  int width = 0;
  int height = 0;
  const CellMoments<C>* cells = nullptr;  // row by row
  // The image moments of SweepOptions::means, likewise; of levels 0 and 1 alone.
  const ChannelMoments<C>* means = nullptr;
  const AxisCells* x_cells = nullptr;
  const AxisCells* y_cells = nullptr;
  std::int64_t index = 0;  // which tile; the whole grid of a coarse level comes last

  const CellMoments<C>& at(int x, int y) const { return cells[index_of(x, y)]; }
  const ChannelMoments<C>& means_at(int x, int y) const { return means[index_of(x, y)]; }
  std::ptrdiff_t index_of(int x, int y) const { return static_cast<std::ptrdiff_t>(y) * width + x; }
  /// Where the block's columns and rows of cells lie among the texels of a level, this one or the
  /// next.
  const CellPlace* x_places(int of) const { return x_cells->places(level, of).data() + x0; }
  const CellPlace* y_places(int of) const { return y_cells->places(level, of).data() + y0; }
};

/// Calls use(x, x_end, y, y_end) for the cells of a block between four texel centers of its level.
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

/// Calls use(moments, column, row) for each cell between the texel centers (column, row) and
/// (column + 1, row + 1) of a block's level that some of the surface in the block lies in, with the
/// moments of that part in the coordinates of this cell.
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

/// The same of the image moments of the means, for a block that has them.
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
  // With kSrgbAfter the colors of the image are encoded, and its moments are those of the decoded
  // lookup: by FourPointRule in each of the finest cells.
  Reader reader = Reader::kLinear;
  // Another image of the same size and channels, whose moments come along in MomentBlock::means;
  // not with kSrgbAfter.
  const Image* means = nullptr;
  int threads = 0;
};

/// How many different values MomentBlock::index takes.
std::int64_t sweep_block_count(int width, int height);

/// Visits every cell of the levels asked for, block by block. Blocks are visited at the
/// same time only where their cells, and the texels of their level beside these, are apart, and any
/// two blocks that are not are visited in the same order whatever the number of threads. `image` is
/// finite and has C channels.
template <int C>
void sweep_moments(const TexelTriangles& triangles, const TexelSource& image, WrapModes wrap,
                   const SweepOptions& options, const Progress& progress,
                   const std::function<void(const MomentBlock<C>&)>& visit);

}  // namespace prefilter
