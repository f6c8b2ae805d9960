// SPDX-License-Identifier: GPL-3.0-or-later

// Least-squares system of one level: the texels whose bilinear lookups come closest to the image
// over the surface (section 7.3 with the bilinear basis).
#pragma once

#include <memory>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/lanes.h"
#include "prefilter/base/run.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/wrap.h"
#include "prefilter/textures/mipmap/level_coupling.h"
#include "prefilter/textures/mipmap/seam_links.h"
#include "prefilter/textures/mipmap/seam_search.h"
#include "prefilter/textures/texels/moment_sweep.h"

namespace prefilter {

/// The target of a level's fit: a weighted sum of images.
struct TargetShares {
  double image = 1.0;
  double finer_means = 0.0;  // the means p of the next finer level, interpolated bilinearly
  double own_means = 0.0;    // the means p of this level, interpolated bilinearly
};

/// The target of a level whose pixels have a footprint of `footprint` texels of the level, from 0
/// to kMaxFootprint.
///
/// Averaging the image under tents and then interpolating the means with the same tents filters it,
/// on average over positions, with a cubic B-spline. The variance of this kernel for the tents of
/// the next finer level equals the variance of a box one texel of this level wide; for the tents of
/// this level, of a box two texels wide. For footprints in between the two are mixed to match the
/// variance of the box.
TargetShares target_shares(double footprint);
inline constexpr double kMaxFootprint = 2.0;

/// Integrals over the surface per channel, which complete the equations to a squared error.
struct TargetSquares {
  ChannelSums image{};  // of the square of the image
  ChannelSums means{};  // of the square of the means p of a level, if they are part of a target
  ChannelSums image_means{};  // of the image times these means
};

/// Scaling of a level's equations within a larger system: they are multiplied by `times`, and their
/// target is reduced by `known` times the image.
struct EquationShares {
  double times = 1.0;
  double known = 0.0;
};

/// Minimizes, over the texels t of a level and for each channel,
///   integral over the surface of (sum_j b_j t_j - I)^2 + kRegularization * m * sum_j (t_j - p_j)^2
/// where I is the target, the image by default; b_j are the bilinear basis functions, m is the mean
/// of the integrals of b_j^2 over the texels in use, and p_j is the mean of the image under b_j.
/// The second term determines texels that hardly any of the surface reads, and hardly affects
/// others.
template <int C>
class BilinearSystem {
 public:
  static constexpr double kRegularization = 1e-3;

  BilinearSystem(int width, int height, WrapModes wrap);

  /// Adds the integrals over a block of cells of this level. Blocks that share texels must not be
  /// added concurrently.
  void add(const MomentBlock<C>& block);

  /// The means p_j; 0 for texels that no lookup reads. Requires all blocks.
  Image means() const;

  /// Allocates the sums for `add_finer_means`.
  void expect_finer_means() { finer_means_.resize(system_.size()); }
  /// For level 1: adds the integrals over a block of cells of the means of level 0. Concurrency is
  /// as for `add`.
  void add_finer_means(const MomentBlock<C>& block);
  /// Adds the integrals of the means of the next finer level, from its coupling with this level.
  void add_finer_means(const LevelCoupling& coupling, const Image& means, const Run& run) {
    coupling.add_fine(means, system_, run, &finer_means_);
  }

  struct Solution {
    Image image;                      // 0 in texels that no lookup reads
    std::vector<unsigned char> used;  // 1 for each texel that the surface reads
    int sweeps = 0;
  };

  /// Adds the square of each link to the objective, weighted by the area of its strip in space,
  /// times `texels_by_area`, times a weight that `solve` determines. Requires all blocks.
  void add_links(const std::vector<SeamLink>& links, double texels_by_area, const Run& run);
  bool has_links() const { return !links_.empty(); }
  /// Sets the weight of the links. Requires `prepare`.
  void weigh_links(double weight) {
    system_.weigh_links(&links_, Lanes{} + static_cast<float>(weight));
  }
  /// Sets the squares of the image and of the next finer level's means. Required to solve with
  /// links.
  void set_squares(const TargetSquares& squares) { squares_ = squares; }
  /// The squares of the image and of this level's means, for the next level. Requires links and
  /// `prepare`.
  const TargetSquares& own_squares() const { return own_squares_; }

  /// Solves for all channels, within their ranges. If there are links, the squared error over the
  /// surface of the channels from budget.first_channel on rises by at most the budget; without,
  /// `budget` may be null. Can be called only once.
  Solution solve(const TargetShares& target, const SolveOptions& options, SeamBudget* budget,
                 const Run& run);

  /// The steps of `solve`, for other solvers that continue from them. `prepare` sets up the system
  /// with the texels at their means p_j.
  void prepare(const TargetShares& target, const EquationShares& shares, const Run& run);
  NinePointSystem<float>& system() { return system_; }
  /// Number of sweeps for a fit with a changed weight of the links.
  int linked_sweeps() const;
  /// Squared error of the current texels, over the channels from `first_channel` on. Requires
  /// links.
  double squared_error(int first_channel, int threads) const;
  /// The squared error if all texels were 0.
  double target_square(int first_channel) const;
  Solution take_solution();

 private:
  // Initializes texels to their means p_j, excludes those that no lookup reads, and adds the
  // regularization.
  void start_at_means(const Run& run);
  // Integral of the squared target. `own_finer` is the integral of this level's means times the
  // finer level's.
  ChannelSums square_of_target(const TargetShares& target, const ChannelSums& own_finer) const;
  void add_dual_cell(const CellMoments<C>& moments, int column, int row);
  // The texel at corner k, [2 * y + x], of a cell between texel centers; -1 for the border.
  std::ptrdiff_t corner(int column, int row, int k) const;

  WrapModes wrap_;
  NinePointSystem<float> system_;
  std::vector<float> weights_;           // integrals of b_j
  std::vector<LaneValues> finer_means_;  // integrals of b_j times the finer level's means
  LinkForm links_;
  // For the squared error, with links only.
  TargetSquares squares_;
  TargetSquares own_squares_;
  ChannelSums target_square_{};
  std::vector<LaneValues> target_;  // integrals of b_j times the target
  float regularization_ = 0.0F;
};

/// Adds the means of each level to the target of the next. couplings[k] couples systems[k] and
/// systems[k + 1].
template <int C>
void add_coupled_means(const std::vector<LevelCoupling>& couplings,
                       const std::vector<std::unique_ptr<BilinearSystem<C>>>& systems,
                       const Run& run) {
  for (std::size_t k = 0; k + 1 < systems.size(); ++k) {
    systems[k + 1]->add_finer_means(couplings[k], systems[k]->means(), run);
  }
}

}  // namespace prefilter
