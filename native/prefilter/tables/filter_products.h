// SPDX-License-Identifier: GPL-3.0-or-later

// Inner products of filters along an axis: of texels with each other, and with the filter of a
// sample. Those of the plane are products of two.
#pragma once

#include "prefilter/filters/kernel.h"

namespace prefilter {

/// Positions are in cells, see sampling_table.h.
///
/// For three levels the product is the integral over the line. For fewer the finest level is the
/// image itself: a filter is then what it weighs the image's texels with (kernel_taps), and the
/// product is a sum over them.
class FilterProducts {
 public:
  FilterProducts(const Kernel& kernel, int levels) : kernel_(kernel), levels_(levels) {}

  int levels() const { return levels_; }

  /// The filter's unit in cells, at a fraction of the way from the finer level to the cell's.
  double width(double f) const;

  /// Of the texels number i and j, each of the level so much finer than the cell's.
  double of_texels(int finer_i, int i, int finer_j, int j) const;

  /// Of a texel and of the filter of a sample at x.
  double with_sample(int finer, int i, double x, double f) const;

  /// Of the filter of a sample at x with itself.
  double of_sample(double x, double f) const;

  /// The texels of a level, first to last, that a filter at some x from `low` to `high`, `width`
  /// cells wide, overlaps.
  struct Texels {
    int first;
    int last;
  };
  Texels overlapping(int finer, double low, double high, double width) const;

 private:
  struct Filter {
    double center;
    double width;
  };
  static Filter texel(int finer, int i);
  double product(const Filter& a, const Filter& b) const;
  double integral(const Filter& a, const Filter& b) const;
  double sum(const Filter& a, const Filter& b) const;

  const Kernel& kernel_;
  int levels_;
};

}  // namespace prefilter
