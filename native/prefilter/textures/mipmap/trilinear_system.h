// SPDX-License-Identifier: GPL-3.0-or-later

// Least-squares system of all levels together, for trilinear lookups (section 7.3).
#pragma once

#include <memory>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/textures/mipmap/bilinear_system.h"
#include "prefilter/textures/mipmap/level_coupling.h"
#include "prefilter/textures/texels/moment_sweep.h"

namespace prefilter {

/// Minimizes the integral, over mip values from 0 to the last level and over the surface, of the
/// squared difference between the trilinear lookup and the image. Level 0 is the image, and the
/// last level, of 1 x 1 texel, its mean over the surface. The levels in between are unknown,
/// regularized as in BilinearSystem. Over the interval between two levels the products of their
/// weights integrate to 1/3, 1/6 and 1/3, so the normal matrix is block tridiagonal: 2/3 A_l,l on
/// the diagonal and 1/6 A_l,l+1 beside it.
template <int C>
class TrilinearSystem {
 public:
  TrilinearSystem(int width, int height, WrapModes wrap);

  /// Adds a block of cells of any level from 1 on. Blocks that share texels must not be added
  /// concurrently.
  void add(const MomentBlock<C>& block);

  /// Like BilinearSystem::expect_finer_means, for all levels; takes blocks of level 1.
  void expect_finer_means();
  void add_finer_means(const MomentBlock<C>& block) { systems_.front()->add_finer_means(block); }
  /// Requires all blocks.
  void add_coupled_means(const Run& run) {
    prefilter::add_coupled_means(couplings_, systems_, run);
  }

  /// BilinearSystem::add_links for a level.
  void add_links(int level, const std::vector<SeamLink>& links, double texels_by_area,
                 const Run& run) {
    systems_[level - 1]->add_links(links, texels_by_area, run);
  }
  /// BilinearSystem::set_squares for level 1.
  void set_squares(const TargetSquares& squares) { squares_ = squares; }

  /// Solves for levels 1 to the last, within the ranges. At mip value m a pixel covers `footprint`
  /// times 2^m texels of the image. If there are links, the squared error of bilinear lookups of
  /// each level, at its own mip value, rises by at most the budget. Can be called only once.
  std::vector<typename BilinearSystem<C>::Solution> solve(double footprint,
                                                          const SolveOptions& options,
                                                          SeamBudget budget, const Run& run);

 private:
  using RightSide = std::vector<LaneValues>;

  void prepare(double footprint, const SolveOptions& options, const Run& run);
  // Solves for one level with the others fixed. Returns the number of sweeps.
  int solve_level(int level, const SolveOptions& options, const Run& run);
  // Iterates over the levels until none moves.
  void iterate_levels(const SolveOptions& options, const Run& run);
  // Determines the weights of the links of all levels, and solves with them.
  void fit_links(const SolveOptions& options, const SeamBudget& budget, const Run& run);

  int last_level_;
  std::vector<std::unique_ptr<BilinearSystem<C>>> systems_;  // of level l at [l - 1]
  std::vector<LevelCoupling> couplings_;                     // of levels l and l + 1 at [l - 1]
  std::array<double, C> mean_{};
  std::vector<RightSide> fixed_;  // the target's right side for each level
  RightSide right_;
  TargetSquares squares_;
};

}  // namespace prefilter
