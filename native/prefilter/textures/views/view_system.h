// SPDX-License-Identifier: GPL-3.0-or-later

// The least-squares problem of all levels: which texels, looked up by the pixels of views, come
// closest to what these should show.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/lanes.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/wrap.h"
#include "prefilter/textures/fit_to_views.h"
#include "prefilter/textures/views/seen_pixels.h"

namespace prefilter {

/// Minimizes, over the texels t of levels 1 and up,
///   sum over pixels of w (lookup - shown)^2  +  s sum over pixels of w (change of the difference
///   from the first frame to the second)^2  +  sum over texels of pull (t - start)^2.
class ViewSystem {
 public:
  /// `levels` with level 0, which stays; `pulls` of each level, in means of the diagonal there.
  ViewSystem(const std::vector<ImageView>& levels, const std::vector<double>& pulls,
             std::vector<SeenPixels> seen, const ViewFitOptions& options, const Progress& progress);

  /// Conjugate gradients, then within the ranges; then again for the texels that are not at their
  /// ends.
  std::vector<Image> solve(const SolveOptions& options, const Progress& progress);

 private:
  using Texels = std::vector<LaneValues>;
  using Sums = std::array<double, kMaxChannels>;

  // Calls visit(is_row, share) for the ways to look up that count.
  template <typename Visit>
  void for_ways(const Visit& visit) const;
  // Calls visit(level, texel, weight) for what a pixel looks up, by one lookup or a row of them.
  template <typename Visit>
  void for_texels(const SeenPixel& pixel, bool is_row, const Visit& visit) const;
  template <typename Visit>
  void for_texels_at(double u, double v, float mip, float share, const Visit& visit) const;

  // What pixels show of texels; of level 0 as well where `with_image`.
  Lanes shown(const SeenPixel& pixel, bool is_row, const Texels& texels, bool with_image) const;
  Lanes missing(const SeenPixel& pixel, bool is_row) const;
  // Calls add(seen, texels) for all views, each slice of them with sums of its own, and adds these.
  template <typename Add>
  Texels sum_slices(const Progress& progress, const Add& add) const;
  // Adds what pixels have by `value(pixel, is_row)`, to the texels that they look up.
  template <typename Value>
  void spread(const SeenPixels& seen, const Value& value, Texels* sums) const;

  void make_slices();
  void find_steadiness(double steadiness, const Progress& progress);
  void find_diagonal(const std::vector<double>& pulls, const Progress& progress);
  void improve(int steps, Texels* texels, const Progress& progress) const;
  Sums dot(const Texels& a, const Texels& b) const;

  std::vector<ImageView> levels_;
  std::vector<std::size_t> begins_;  // of levels, where level 0 has no texels
  WrapModes wrap_;
  Lookups lookups_;
  int threads_;
  std::vector<SeenPixels> seen_;
  std::vector<std::size_t> slices_;  // where ranges of views begin, and the last one ends
  float steadiness_ = 0.0F;
  Texels start_;
  Texels missing_;  // the right side, of what there is beyond the start
  Texels free_;     // 1 for channels of texels that may change, else 0
  std::vector<float> diagonal_;
  std::vector<float> pulls_;  // by texel
};

}  // namespace prefilter
