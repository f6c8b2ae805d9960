// SPDX-License-Identifier: GPL-3.0-or-later

// Integrals over the surface, summed cell by cell, to which levels are fitted.
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/textures/mipmap/bilinear_system.h"
#include "prefilter/textures/mipmap/encoded_fit.h"
#include "prefilter/textures/texels/moment_sweep.h"

namespace prefilter {

/// The systems of all levels, to be solved independently.
template <int C>
struct LevelSystems {
  std::vector<std::unique_ptr<BilinearSystem<C>>> linear;  // of level l at [l - 1]
  std::vector<std::unique_ptr<EncodedFit<C>>>
      encoded;                           // of level l at [l - 1]; empty for the linear reader
  std::vector<LevelCoupling> couplings;  // of levels l and l + 1 at [l - 1], to pass on means

  /// For levels 1 to level_count - 1 of an image.
  LevelSystems(int width, int height, int level_count, WrapModes wrap, Reader reader);

  void add(const MomentBlock<C>& block);
  /// Like TrilinearSystem::expect_finer_means; to be called before blocks are added.
  void expect_finer_means();
  void add_finer_means(const MomentBlock<C>& block) { linear.front()->add_finer_means(block); }
  void add_coupled_means(const Run& run);

 private:
  int width_;
  int height_;
  WrapModes wrap_;
};

template <int C>
using AddBlock = std::function<void(const MomentBlock<C>&)>;

/// The images of a sweep.
struct SweptImage {
  const TexelSource& swept;  // the image as its reader looks it up: encoded for a decoding reader
  const ImageView& floats;   // the image
  const Image* means = nullptr;  // its means under the tents of its texels; null if not needed
};

/// Calls add(block) for the blocks of levels 1 to `last_level`. If `has_squares`, returns the
/// integrals of the squares of the image, as the reader shows it, and of the means.
template <int C>
TargetSquares sum_image(const TexelTriangles& triangles, const SweptImage& image, WrapModes wrap,
                        Reader reader, bool has_squares, int last_level, const Run& run,
                        const AddBlock<C>& add);

}  // namespace prefilter
