// SPDX-License-Identifier: GPL-3.0-or-later

// Integrals over the surface, cell by cell, that levels are fitted by.
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/mipmap/bilinear_system.h"
#include "prefilter/mipmap/encoded_fit.h"
#include "prefilter/texels/moment_sweep.h"

namespace prefilter {

/// The systems of levels, each to be solved by itself.
template <int C>
struct LevelSystems {
  std::vector<std::unique_ptr<BilinearSystem<C>>> linear;  // of level l at [l - 1]
  std::vector<std::unique_ptr<EncodedFit<C>>> encoded;     // likewise; none for the linear reader

  /// For levels 1 to level_count - 1 of an image.
  LevelSystems(int width, int height, int level_count, WrapModes wrap, Reader reader);

  void add(const MomentBlock<C>& block);
  /// Of levels 0 (none) to the last but one.
  std::vector<Image> means() const;
  void expect_finer_means();
  void add_finer_means(const MomentBlock<C>& block);
};

template <int C>
using AddBlock = std::function<void(const MomentBlock<C>&)>;

/// Calls add(block) for the blocks of levels 1 to `last_level`. Where `has_squares` it returns the
/// integrals of the square of what the reader shows of the image; `floats` is the image, and
/// `swept` the same as it is swept over: encoded, for a reader that decodes.
template <int C>
ChannelSums sum_image(const TexelTriangles& triangles, const TexelSource& swept,
                      const ImageView& floats, WrapModes wrap, Reader reader, bool has_squares,
                      int last_level, const Progress& progress, int threads,
                      const AddBlock<C>& add);

/// The means of every level's texels are what the next sees: calls add(block) for the blocks of
/// levels 1 to the number of `level_means`, those of levels 0 (not looked at) to the last but one.
/// For level 0 the image is its own means, `image_means`. Where `has_squares` the integrals of the
/// square of these, and of their product with the image, go into `squares`.
template <int C>
void sum_means(const TexelTriangles& triangles, const ImageView& image_means,
               const std::vector<Image>& level_means, const ImageView& floats, WrapModes wrap,
               bool has_squares, const Progress& progress, int threads, const AddBlock<C>& add,
               TargetSquares* squares);

}  // namespace prefilter
