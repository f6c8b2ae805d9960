// SPDX-License-Identifier: GPL-3.0-or-later

// Fits one level for readers that interpolate encoded texels and decode the result.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/wrap.h"
#include "prefilter/textures/mipmap/seam_links.h"
#include "prefilter/textures/mipmap/seam_search.h"
#include "prefilter/textures/texels/moment_sweep.h"

namespace prefilter {

/// Minimizes, over the encoded texels t of a level and for each color channel,
///   integral over the surface of (decode(sum_j b_j t_j) - I)^2
///     + kRegularization * m * sum_j (t_j - s_j)^2
/// with b_j and m as in BilinearSystem, m scaled by the slope of the decoding curve, and the start
/// s. Gauss-Newton with quadrature: each cell between texel centers is sampled at the four points
/// of FourPointRule.
template <int C>
class EncodedFit {
 public:
  static constexpr double kRegularization = 1e-3;

  /// For a level of width x height texels of an image of image_width x image_height texels.
  EncodedFit(int width, int height, int image_width, int image_height, WrapModes wrap);

  /// Adds a block of cells of this level. Blocks may be added concurrently.
  void add(const MomentBlock<C>& block);

  /// Like BilinearSystem::add_links, but links encoded texels. `squares` are the integrals of the
  /// squared image as the reader shows it.
  void add_links(const std::vector<SeamLink>& links, double texels_by_area,
                 const ChannelSums& squares);

  /// Improves `start`; it and the ranges are encoded. A fourth channel is not changed. `used` is 1
  /// for each texel that the surface reads. If there are links, the error of the colors rises by at
  /// most the budget. Can be called only once.
  Image solve(const Image& start, const std::vector<unsigned char>& used,
              const SolveOptions& options, SeamBudget* budget, const Run& run);

 private:
  static constexpr int kColors = C < 3 ? C : 3;

  struct Cell {
    int column, row;
    float x[2], y[2];      // of the points, relative to the center of texel (column, row)
    float same, opposite;  // quadrature weights of FourPointRule
    std::array<std::array<float, kColors>, 4> image;  // integrals at the points
  };

  using ColorSums = std::array<double, kColors>;

  // Assembles the Gauss-Newton system at the current texels. Returns the sum of squares of each
  // channel, up to a constant and without links.
  ColorSums assemble(const Run& run);
  // The links' contribution to the sums of squares.
  ColorSums link_squares(double weight) const;
  // A difference of encoded values is weighted by the curve's mean squared slope at the start,
  // which stays fixed so that all iterations have the same objective.
  Lanes link_weights(double weight) const;
  // The sums of squares of the current texels including links of this weight. Assembles the system.
  ColorSums sums_with_links(double weight, const Run& run);
  // Halves the step from `before` to the current texels until no channel's sum is above `least`,
  // starting from their sums `sums`. Returns the final sums.
  ColorSums backtrack(const std::vector<LaneValues>& before, const ColorSums& least, double weight,
                      const Run& run, ColorSums sums);
  // Adds the regularization toward the start to the system.
  void add_regularization(const Image& start, const std::vector<unsigned char>& used);
  // Gauss-Newton iterations from the current texels to the fit with links of this weight.
  void iterate(const Image& start, const std::vector<unsigned char>& used, double weight,
               const SolveOptions& options, const Run& run);

  struct Sums {
    ColorSums squares{};
    ColorSums slopes{};  // sums of the curve's squared slope, weighted by mass
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
  ColorSums mean_slopes_{};  // mean squared slope of the curve over the surface
  ChannelSums image_squares_{};
};

}  // namespace prefilter
