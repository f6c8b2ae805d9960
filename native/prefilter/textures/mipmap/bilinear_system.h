// SPDX-License-Identifier: GPL-3.0-or-later

// The least-squares problem of one level: which texels, looked up bilinearly, come closest to the
// image over the surface (section 7.3 with the bilinear basis).
#pragma once

#include <memory>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/lanes.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/wrap.h"
#include "prefilter/textures/mipmap/level_coupling.h"
#include "prefilter/textures/mipmap/seam_links.h"
#include "prefilter/textures/mipmap/seam_search.h"
#include "prefilter/textures/texels/moment_sweep.h"

namespace prefilter {

/// What stands on the right of a level's equations in place of the image: a sum of images, each
/// times its share.
struct TargetShares {
  double image = 1.0;
  double finer_means = 0.0;  // the means p of the next finer level, interpolated between its texels
  double own_means = 0.0;    // the same of this level
};

/// The target of a level whose pixels cover `footprint` of its texels, from 0 to kMostFootprint.
///
/// Tents that weigh the image for a mean, and tents that interpolate the means, make a kernel that
/// is a cubic B-spline on average over its places: with the tents of the next finer level its
/// variance is that of a box as wide as a texel of this level, with those of this level of one
/// twice as wide. Between them kernels are mixed so that their variances are the box's.
TargetShares target_shares(double footprint);
inline constexpr double kMostFootprint = 2.0;

/// Integrals over the surface, by channel, that a squared error needs beside the equations.
struct TargetSquares {
  ChannelSums image{};        // of the image's square
  ChannelSums means{};        // of that of the means p of a level, where they are part of a target
  ChannelSums image_means{};  // of the image times these means
};

/// How the equations of a level are part of larger ones: those for the target less `known` times
/// the image, all times `times`.
struct EquationShares {
  double times = 1.0;
  double known = 0.0;
};

/// Minimizes, over the texels t of a level and for each channel,
///   integral over the surface of (sum_j b_j t_j - I)^2  +  kPull * m * sum_j (t_j - p_j)^2
/// where I is the image, or another target; b_j are the bilinear basis functions, m is the mean of
/// the integrals of b_j^2 over the texels in use, and p_j is the mean of the image under b_j. The
/// second term decides for texels that hardly any of the surface reads, and leaves the others
/// alone.
template <int C>
class BilinearSystem {
 public:
  static constexpr double kPull = 1e-3;

  BilinearSystem(int width, int height, WrapModes wrap);

  /// Adds the integrals over the cells of one block of this level. Blocks that share texels must
  /// not be added at the same time.
  void add(const MomentBlock<C>& block);

  /// The means p_j, 0 for texels that nothing reads; to be called once all blocks are there.
  Image means() const;

  /// Makes room for `add_finer_means`.
  void expect_finer_means() { finer_means_.resize(system_.size()); }
  /// Adds the integrals over the cells of one block of the means of level 0, for level 1. Blocks as
  /// for `add`.
  void add_finer_means(const MomentBlock<C>& block);
  /// Adds those of the means of the next finer level, by its coupling with this one.
  void add_finer_means(const LevelCoupling& coupling, const Image& means, const Progress& progress,
                       int threads) {
    coupling.add_fine(means, system_, progress, threads, &finer_means_);
  }

  struct Solution {
    Image image;                      // texels that nothing reads are 0
    std::vector<unsigned char> used;  // 1 for each texel that the surface reads
    int sweeps = 0;
  };

  /// Adds, to what is minimized, the square of each link, which counts its strip's area in space
  /// times `texels_by_area`, and a weight that `solve` finds. To be called once all blocks are
  /// there.
  void add_links(const std::vector<SeamLink>& links, double texels_by_area,
                 const Progress& progress);
  bool has_links() const { return !links_.empty(); }
  /// From here on links count, with that weight. To be called after `prepare`.
  void weigh_links(double weight) {
    system_.weigh_links(&links_, Lanes{} + static_cast<float>(weight));
  }
  /// Before links can be solved for: the squares of the image, and of the next finer level's means.
  void set_squares(const TargetSquares& squares) { squares_ = squares; }
  /// Those of the image and this level's means, for the next level; after `prepare`, with links.
  const TargetSquares& own_squares() const { return own_squares_; }

  /// Solves for all channels, within their ranges. With links the squared error over the surface,
  /// over the channels from budget.first_channel on, rises by no more than the budget allows;
  /// without, `budget` may be null. Can be called once.
  Solution solve(const TargetShares& target, const SolveOptions& options, SeamBudget* budget,
                 const Progress& progress);

  /// The steps of `solve`, for those who go on from there. `prepare` makes the system ready, with
  /// texels at their means p_j.
  void prepare(const TargetShares& target, const EquationShares& shares, const Progress& progress);
  NinePointSystem<float>& system() { return system_; }
  /// How many sweeps a fit with another weight of the links is worth.
  int linked_sweeps() const;
  /// The squared error of the texels as they are, over the channels from `first_channel` on; only
  /// where there are links.
  double squared_error(int first_channel, int threads) const;
  /// The same of texels that are 0.
  double target_square(int first_channel) const;
  Solution take_solution();

 private:
  // Puts texels at their means p_j, and leaves out those that nothing reads; sets the pull.
  void start_at_means(const Progress& progress);
  // The integral of the target's square; `own_finer` is that of this level's means times the finer
  // level's.
  ChannelSums square_of_target(const TargetShares& target, const ChannelSums& own_finer) const;
  void add_dual_cell(const CellMoments<C>& moments, int column, int row);
  // The texel at corner k, [2 * y + x], of a cell between texel centers; -1 for the border.
  std::ptrdiff_t corner(int column, int row, int k) const;

  WrapModes wrap_;
  NinePointSystem<float> system_;
  std::vector<float> weights_;           // integrals of b_j
  std::vector<LaneValues> finer_means_;  // integrals of b_j times the finer level's means
  LinkForm links_;
  // For the squared error, where there are links.
  TargetSquares squares_;
  TargetSquares own_squares_;
  ChannelSums target_square_{};
  std::vector<LaneValues> target_;  // integrals of b_j times the target
  float pull_ = 0.0F;
};

/// Adds the means of each level to what the next one needs of them: couplings[k] is that of
/// systems[k] and systems[k + 1].
template <int C>
void add_coupled_means(const std::vector<LevelCoupling>& couplings,
                       const std::vector<std::unique_ptr<BilinearSystem<C>>>& systems,
                       const Progress& progress, int threads) {
  for (std::size_t k = 0; k + 1 < systems.size(); ++k) {
    systems[k + 1]->add_finer_means(couplings[k], systems[k]->means(), progress, threads);
  }
}

}  // namespace prefilter
