// SPDX-License-Identifier: GPL-3.0-or-later

// A linear paint expressed on each cell.
#pragma once

#include <array>

#include "prefilter/shapes/paint.h"
#include "prefilter/shapes/raster/cell_filter.h"

namespace prefilter {

/// Coefficients or integrals of 1, u and v, the coordinates relative to a cell's center.
using LinearPowers = std::array<double, 3>;

/// The exponents of u and v in LinearPowers.
inline constexpr std::array<std::array<int, 2>, 3> kLinearExponents = {{{0, 0}, {1, 0}, {0, 1}}};

class LocalColor {
 public:
  /// The paint must be linear; it and the filter must outlive this object.
  LocalColor(const Paint& paint, const CellFilter& filter) : paint_(paint), filter_(filter) {}

  int channels() const { return paint_.channels; }
  /// For each channel, the value at a cell's center and its increase along a cell in u and v.
  void powers(int column, int row, std::array<LinearPowers, kMaxChannels>* out) const;
  /// Adds the integral of the color over a part of a cell, given the integrals of 1, u and v.
  void add_integral(int column, int row, const LinearPowers& moments, double* out) const;
  /// Adds `share` times the means over cells [begin, end) to `out`, the values of the first cell
  /// on.
  void add_means(int begin, int end, int row, double share, double* out) const;

 private:
  const Paint& paint_;
  const CellFilter& filter_;
};

}  // namespace prefilter
