// SPDX-License-Identifier: GPL-3.0-or-later

// Least-squares system for all levels together: the texels whose lookups in the pixels of views
// come closest to the target colors.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/lanes.h"
#include "prefilter/base/run.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/wrap.h"
#include "prefilter/textures/fit_to_views.h"
#include "prefilter/textures/views/view_pixels.h"

namespace prefilter {

/// Minimizes over the texels t of levels 1 and up
///   sum over pixels of w (lookup - target)^2
///   + s sum over pixels of w (change of lookup - target from the first frame to the second)^2
///   + sum over texels of start_weight (t - start)^2
/// by conjugate gradients with a diagonal preconditioner.
class ViewSystem {
 public:
  /// `levels` includes level 0, which stays fixed. `start_weights` has one entry per level,
  /// relative to the mean of the diagonal there.
  ViewSystem(const std::vector<ImageView>& levels, const std::vector<double>& start_weights,
             std::vector<ViewPixels> seen, const ViewFitOptions& options, const Run& run);

  /// Solves without bounds, clips to the ranges, and continues with the texels at their bounds
  /// fixed.
  std::vector<Image> solve(const SolveOptions& options, const Run& run);

 private:
  using Texels = std::vector<LaneValues>;
  using Sums = std::array<double, kMaxChannels>;

  // Calls visit(is_anisotropic, share) for each kind of lookup in use.
  template <typename Visit>
  void for_lookup_kinds(const Visit& visit) const;
  // Calls visit(level, texel, weight) for the texels that a pixel's lookup reads.
  template <typename Visit>
  void for_texels(const ViewPixel& pixel, bool is_anisotropic, const Visit& visit) const;
  template <typename Visit>
  void for_texels_at(double u, double v, float mip, float share, const Visit& visit) const;

  // The color that a pixel's lookup returns, with level 0 only if `with_image`.
  Lanes lookup(const ViewPixel& pixel, bool is_anisotropic, const Texels& texels,
               bool with_image) const;
  Lanes residual_of(const ViewPixel& pixel, bool is_anisotropic) const;
  // Calls add(seen, sums) for all views, in parallel slices with sums of their own, and returns the
  // total.
  template <typename Add>
  Texels sum_slices(const Run& run, const Add& add) const;
  // The adjoint of `lookup`: adds value(pixel, is_anisotropic), weighted, to the texels that each
  // pixel reads.
  template <typename Value>
  void scatter(const ViewPixels& seen, const Value& value, Texels* sums) const;

  void make_slices();
  void scale_steadiness(double steadiness, const Run& run);
  void compute_diagonal(const std::vector<double>& start_weights, const Run& run);
  void iterate(int steps, Texels* texels, const Run& run) const;
  Sums dot(const Texels& a, const Texels& b) const;

  std::vector<ImageView> levels_;
  std::vector<std::size_t>
      begins_;  // of each level in the vectors of texels; level 0 has no entries
  WrapModes wrap_;
  Lookups lookups_;
  int threads_;
  std::vector<ViewPixels> seen_;
  std::vector<std::size_t> slices_;  // ranges of views: slice k is [slices_[k], slices_[k + 1])
  float steadiness_ = 0.0F;
  Texels start_;
  Texels right_side_;  // for the change from the start
  Texels is_free_;     // 1 for channels that may change, else 0
  std::vector<float> diagonal_;
  std::vector<float> start_weights_;  // by texel
};

}  // namespace prefilter
