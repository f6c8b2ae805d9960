// SPDX-License-Identifier: GPL-3.0-or-later

// The fit of one level for a reader that interpolates encoded texels and decodes the result.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/wrap.h"
#include "prefilter/textures/mipmap/seam_links.h"
#include "prefilter/textures/mipmap/seam_search.h"
#include "prefilter/textures/texels/moment_sweep.h"

namespace prefilter {

/// Minimizes, over the encoded texels t of a level and for each color channel,
///   integral over the surface of (decode(sum_j b_j t_j) - I)^2
///     + kPull * m * sum_j (t_j - s_j)^2
/// with b_j and m as for BilinearSystem, m scaled by the curve's slope, and s the start.
/// Gauss-Newton with quadrature: each cell between texel centers is read at the four points of
/// FourPointRule.
template <int C>
class EncodedFit {
 public:
  static constexpr double kPull = 1e-3;

  /// For a level of width x height texels, of an image of image_width x image_height.
  EncodedFit(int width, int height, int image_width, int image_height, WrapModes wrap);

  /// Adds the cells of one block of this level. Blocks may be added at the same time.
  void add(const MomentBlock<C>& block);

  /// As BilinearSystem::add_links, of encoded texels; `squares` are the integrals of what the
  /// reader shows of the image, squared.
  void add_links(const std::vector<SeamLink>& links, double texels_by_area,
                 const ChannelSums& squares);

  /// Improves on `start`, encoded texels within the ranges, which are encoded too. A fourth channel
  /// stays as it is. `used` has 1 for each texel that the surface reads. With links the error of
  /// the colors rises by no more than the budget allows. Can be called once.
  Image solve(const Image& start, const std::vector<unsigned char>& used,
              const SolveOptions& options, SeamBudget* budget, const Progress& progress);

 private:
  static constexpr int kColors = C < 3 ? C : 3;

  struct Cell {
    int column, row;
    float x[2], y[2];      // of the points, from the center of texel (column, row)
    float same, opposite;  // weights
    std::array<std::array<float, kColors>, 4> image;  // integrals at the points
  };

  using ColorSums = std::array<double, kColors>;

  // Puts the Gauss-Newton system at the texels together; returns the sum of squares of each
  // channel, less what does not depend on the texels, and without links.
  ColorSums assemble(int threads, const Progress& progress);
  // What links of this weight add to it.
  ColorSums link_squares(double weight) const;
  // A difference of encoded values counts as the decoded one that the curve's mean slope makes of
  // it: of the slopes at the start, so that all rounds minimize the same.
  Lanes link_weights(double weight) const;
  // The sums of squares of the texels as they are, with those of links of this weight; assembles.
  ColorSums sums_with_links(double weight, int threads, const Progress& progress);
  // Halves the way that the texels went since `before`, until no channel's sum, of those that there
  // are now, is above its `least`. Returns the sums there.
  ColorSums go_back(const std::vector<LaneValues>& before, const ColorSums& least, double weight,
                    int threads, const Progress& progress, ColorSums sums);
  // Adds what pulls texels to their start to the system.
  void add_pull(const Image& start, const std::vector<unsigned char>& used);
  // Rounds from where the texels are, to the fit with links of this weight.
  void improve(const Image& start, const std::vector<unsigned char>& used, double weight,
               const SolveOptions& options, const Progress& progress);

  struct Sums {
    ColorSums squares{};
    ColorSums slopes{};  // squares of the curve's slope, times mass
    double mass = 0.0;
  };
  Sums assemble(const std::vector<Cell>& cells);

  WrapModes wrap_;
  int image_height_;
  int tile_columns_;
  int tile_rows_;
  NinePointSystem<LaneValues> system_;
  std::vector<std::vector<Cell>> cells_;  // by block
  std::vector<TexelLink> all_links_;
  LinkForm links_;
  bool has_slopes_ = false;
  ColorSums mean_slopes_{};  // squares of the curve's slope, over the surface
  ChannelSums image_squares_{};
};

}  // namespace prefilter
