// SPDX-License-Identifier: GPL-3.0-or-later

// Inner products of filters along an axis: of texels with each other, and with the filter of a
// sample. Products in the plane are sums of products of two of these.
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
/// For white images and three levels, the product is the integral over the line. If there are fewer
/// levels, the finest one is the image itself. A filter is then its kernel_taps on the image's
/// texels, and the product is a sum over them.
///
/// For natural images, the product is the expected correlation of two filtered values: the double
/// integral, or sum, of a(x) b(y) exp(-r^2 / 2 s^2) with the distance r. In the plane, a sum of
/// such Gaussians, each twice as wide as the one before, falls with the logarithm of the distance,
/// which corresponds to power that falls with the square of the frequency. Each Gaussian (a scale)
/// separates into a factor along x and one along y.
class FilterProducts {
 public:
  static constexpr int kMaxScales = 9;
  using Products = std::array<double, kMaxScales>;  // entries beyond scales() are 0

  /// `texels` is the kernel of the levels, `sample` the kernel of samples; they may be the same.
  FilterProducts(const Kernel& texels, const Kernel& sample, int levels, ImageSpectrum spectrum);

  int levels() const { return levels_; }
  int scales() const { return spectrum_ == ImageSpectrum::kWhite ? 1 : kMaxScales; }

  /// The filter's unit in cells, at a fraction of the way from the finer level to the cell's.
  double width(double f) const;

  // The functions below cache transforms of the kernels, so they are not thread-safe.

  /// Product of texels i and j, with each level's distance from the cell's level.
  Products of_texels(int finer_i, int i, int finer_j, int j);

  /// Product of a texel and the filter of a sample at x.
  Products with_sample(int finer, int i, double x, double f);

  /// Product of the filter of a sample at x with itself.
  Products of_sample(double x, double f);

  /// First and last texel of a level that overlap a filter of width `width`, in cells, at some x
  /// from `low` to `high`.
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

  // Quadrature nodes for a scale: 0, 1, 2, ... times step, in cycles per cell.
  struct Frequencies {
    double step;
    std::vector<double> weights;
  };
  static Frequencies frequencies_of(double deviation, double widest);
  using Transform = std::array<std::vector<double>, kMaxScales>;
  const Transform& transform_of(const Filter& filter);

  const Kernel* texels_;
  const Kernel* sample_;
  int levels_;
  ImageSpectrum spectrum_;
  std::array<Frequencies, kMaxScales> frequencies_;
  std::vector<Products> of_texels_apart_;                             // of level 0, by distance
  std::map<std::pair<const Kernel*, double>, Transform> transforms_;  // by kernel and width
};

}  // namespace prefilter
