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
#include "prefilter/textures/mipmap/bilinear_system.h"
#include "prefilter/textures/mipmap/encoded_fit.h"
#include "prefilter/textures/texels/moment_sweep.h"

namespace prefilter {

/// The systems of levels, each to be solved by itself.
template <int C>
struct LevelSystems {
  std::vector<std::unique_ptr<BilinearSystem<C>>> linear;  // of level l at [l - 1]
  std::vector<std::unique_ptr<EncodedFit<C>>> encoded;     // likewise; none for the linear reader
  std::vector<LevelCoupling> couplings;  // of levels l and l + 1 at [l - 1], for means alone

  /// For levels 1 to level_count - 1 of an image.
  LevelSystems(int width, int height, int level_count, WrapModes wrap, Reader reader);

  void add(const MomentBlock<C>& block);
  /// As those of TrilinearSystem; the first is to be called before blocks are added.
  void expect_finer_means();
  void add_finer_means(const MomentBlock<C>& block) { linear.front()->add_finer_means(block); }
  void add_coupled_means(const Progress& progress, int threads);

 private:
  int width_;
  int height_;
  WrapModes wrap_;
};

template <int C>
using AddBlock = std::function<void(const MomentBlock<C>&)>;

/// What is swept over.
struct SweptImage {
  const TexelSource& swept;      // the image as its reader looks it up: encoded, if that decodes
  const ImageView& floats;       // the image
  const Image* means = nullptr;  // its means under the tents of its texels, where they count
};

/// Calls add(block) for the blocks of levels 1 to `last_level`. Where `has_squares` it returns the
/// integrals of the square of what the reader shows of the image, and those of the means.
template <int C>
TargetSquares sum_image(const TexelTriangles& triangles, const SweptImage& image, WrapModes wrap,
                        Reader reader, bool has_squares, int last_level, const Progress& progress,
                        int threads, const AddBlock<C>& add);

}  // namespace prefilter
