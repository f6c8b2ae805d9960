// The moment pyramid: one pass over the mesh that yields, for every level, the moments of the
// surface and of the image on it.
//
// On the half-texel grid of level l every bilinear basis function of level l, and of every coarser
// level, is one bilinear polynomial per cell (figure 7.4). A cell of that grid at level l + 1 is
// four cells at level l, so its moments are a fixed combination of theirs: the mesh is cut once,
// along the finest grid. The image is cut into tiles that fit a processor's cache; nothing of the
// finest grids is kept.
#pragma once

#include <functional>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/mipmap/texel_triangles.h"
#include "prefilter/moments/cell_moments.h"

namespace prefilter {

/// The half-texel cells [x0, x0 + width) x [y0, y0 + height) of a level, which has 2 cells to a
/// texel along each axis.
template <int C>
struct MomentBlock {
  int level = 0;
  int x0 = 0;
  int y0 = 0;
  int width = 0;
  int height = 0;
  const CellMoments<C>* cells = nullptr;  // row by row
  std::int64_t index = 0;                 // which tile; the whole grid of a coarse level comes last

  const CellMoments<C>& at(int x, int y) const {
    return cells[static_cast<std::ptrdiff_t>(y) * width + x];
  }
};

struct SweepOptions {
  int first_level = 1;  // 0 or 1: the finest level that is visited
  int last_level = 1;
  int threads = 0;
};

/// How many different values MomentBlock::index takes.
std::int64_t sweep_block_count(int width, int height);

/// Visits every half-texel cell of the levels asked for, block by block. Blocks are visited at the
/// same time only where their cells, and the texels of their level beside these, are apart, and any
/// two blocks that are not are visited in the same order whatever the number of threads. `image` is
/// finite, has C channels and sides that are powers of two.
template <int C>
void sweep_moments(const TexelTriangles& triangles, const ImageView& image, WrapModes wrap,
                   const SweepOptions& options, const Progress& progress,
                   const std::function<void(const MomentBlock<C>&)>& visit);

}  // namespace prefilter
