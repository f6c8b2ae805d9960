// SPDX-License-Identifier: GPL-3.0-or-later

// Inner products of filters along an axis: of texels with each other, and with the filter of a
// sample. Those of the plane are sums of products of two.
#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "prefilter/images/kernel.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

/// Positions are in cells, see sampling_table.h.
///
/// For white images and three levels the product is the integral over the line. For fewer the
/// finest level is the image itself: a filter is then what it weighs the image's texels with
/// (kernel_taps), and the product is a sum over them.
///
/// For natural ones it is what two filters have in common on average over images in which values
/// are correlated by their distance r: the double integral, or sum, of a(x) b(y) exp(-r^2 / 2 s^2).
/// In the plane a sum of such Gaussians, each twice as wide as the one before, falls with the
/// logarithm of the distance, which power that falls with the square of the frequency amounts to.
/// Each of them, a scale, comes apart into a product along x and one along y.
class FilterProducts {
 public:
  static constexpr int kMostScales = 9;
  using Products = std::array<double, kMostScales>;  // those beyond scales() are 0

  /// Of levels that `texels` has filtered, and of samples by `sample`, which may be the same.
  FilterProducts(const Kernel& texels, const Kernel& sample, int levels, ImageSpectrum spectrum);

  int levels() const { return levels_; }
  int scales() const { return spectrum_ == ImageSpectrum::kWhite ? 1 : kMostScales; }

  /// The filter's unit in cells, at a fraction of the way from the finer level to the cell's.
  double width(double f) const;

  // These keep what they have found out about the kernels: not for several threads.

  /// Of the texels number i and j, each of the level so much finer than the cell's.
  Products of_texels(int finer_i, int i, int finer_j, int j);

  /// Of a texel and of the filter of a sample at x.
  Products with_sample(int finer, int i, double x, double f);

  /// Of the filter of a sample at x with itself.
  Products of_sample(double x, double f);

  /// The texels of a level, first to last, that a filter at some x from `low` to `high`, `width`
  /// cells wide, overlaps.
  struct Texels {
    int first;
    int last;
  };
  Texels overlapping(int finer, double low, double high, double width) const;

 private:
  struct Filter {
    const Kernel* kernel;
    double center;
    double width;
  };
  Filter texel(int finer, int i) const;
  Filter sample(double x, double f) const { return {sample_, x, width(f)}; }
  Products product(const Filter& a, const Filter& b);
  double integral(const Filter& a, const Filter& b) const;
  Products correlations(const Filter& a, const Filter& b);
  Products sums(const Filter& a, const Filter& b) const;

  // The quadrature of a scale: step times 0, 1, 2, ..., in cycles a cell.
  struct Frequencies {
    double step;
    std::vector<double> weights;
  };
  static Frequencies frequencies_of(double deviation, double widest);
  using Transform = std::array<std::vector<double>, kMostScales>;
  const Transform& transform_of(const Filter& filter);

  const Kernel* texels_;
  const Kernel* sample_;
  int levels_;
  ImageSpectrum spectrum_;
  std::array<Frequencies, kMostScales> frequencies_;
  std::vector<Products> of_texels_apart_;  // of level 0, by how many they are apart
  std::map<std::pair<const Kernel*, double>, Transform> transforms_;  // by the width
};

}  // namespace prefilter
