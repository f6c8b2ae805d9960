// SPDX-License-Identifier: GPL-3.0-or-later

// Overlaps of the bilinear basis functions of one level with those of the next.
#pragma once

#include <array>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/wrap.h"
#include "prefilter/textures/texels/moment_sweep.h"

namespace prefilter {

/// Integrals over the surface of b_j B_k, with b_j a basis function of a level and B_k one of the
/// next coarser level. A texel overlaps at most three texels of the next level along each axis.
class LevelCoupling {
 public:
  LevelCoupling(int width, int height, int next_width, int next_height, WrapModes wrap);

  /// Adds a block of cells of the finer level. Blocks that share texels must not be added
  /// concurrently.
  template <int C>
  void add(const MomentBlock<C>& block);

  /// sums_j -= scale * sum_k <b_j B_k> coarse_k, for every texel of the finer level. `sums` and the
  /// texels of the systems are ordered as in NinePointSystem::at.
  void subtract_coarse(const NinePointSystem<float>& fine, const NinePointSystem<float>& coarse,
                       float scale, int threads, std::vector<LaneValues>* sums) const;
  /// sums_k -= scale * sum_j <b_j B_k> fine_j.
  void subtract_fine(const NinePointSystem<float>& fine, const NinePointSystem<float>& coarse,
                     float scale, int threads, std::vector<LaneValues>* sums) const;
  /// sums_k += sum_j <b_j B_k> image_j, for an image of the finer level's size.
  void add_fine(const Image& image, const NinePointSystem<float>& coarse, const Run& run,
                std::vector<LaneValues>* sums) const;

 private:
  using Triple = std::array<int, 3>;

  // Overlaps along one axis.
  struct Axis {
    int size;
    int next_size;
    Wrap wrap;

    // The first of the three overlapped texels; it may lie beyond the edge.
    int first(int texel) const;
    // Index among these three of `next`, for a cell above texel `low` of the level. `texel` is set
    // to that texel if `high` is 0, to the one after it if 1; after wrapping, and -1 for the
    // border.
    int slot(int low, int high, int next, int* texel) const;
    // The three overlapped texels of every texel, after wrapping; `next_size` for the border.
    std::vector<Triple> next_texels() const;
  };

  // The tents over a cell, along one axis.
  struct Overlap {
    std::array<int, 2> texels{};  // of the level, after wrapping; -1 for the border
    // For tent i % 2 of the level and tent i / 2 of the next: Axis::slot, and the product of the
    // tents as coefficients of 1, x and x^2 in the cell's own coordinate x.
    std::array<int, 4> slots{};
    std::array<std::array<double, 3>, 4> products{};
  };
  static std::vector<Overlap> overlaps(const Axis& axis, const CellPlace* places,
                                       const CellPlace* next_places, int count);

  // sums_k += sum_j <b_j B_k> texel(x, y), for the texels j of the level.
  template <typename Texel>
  void add_fine_texels(const Texel& texel, const NinePointSystem<float>& coarse, const Run& run,
                       std::vector<LaneValues>* sums) const;

  Axis x_;
  Axis y_;
  std::vector<Triple> columns_;
  std::vector<Triple> rows_;
  std::vector<std::array<float, 9>> products_;  // row-major over the level, at [3 * y + x]
};

}  // namespace prefilter
