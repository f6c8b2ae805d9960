// SPDX-License-Identifier: GPL-3.0-or-later

// A paint as a polynomial on each cell.
#pragma once

#include <array>
#include <optional>

#include "prefilter/raster/cell_filter.h"
#include "prefilter/raster/color_nodes.h"
#include "prefilter/raster/raster_layers.h"
#include "prefilter/raster/round_gradient.h"

namespace prefilter {

class LocalColor {
 public:
  /// Of a layer's paint and veils. Both must outlive this.
  LocalColor(const RasterLayer& layer, const CellFilter& filter);

  int channels() const { return layer_.paint.channels; }
  /// 1 for linear colors, 2 for others.
  int degree() const { return is_linear() ? 1 : 2; }
  /// For each channel. Linear colors are what they are; others the polynomial that is nearest in
  /// the mean square, by Gauss's rule of three points along each axis.
  void powers(int column, int row, std::array<ColorPowers, kMaxChannels>* out) const;
  /// Adds the integral of the color over a part of a cell, of which those of 1, u, v, u^2, u v and
  /// v^2 are given; linear colors need the first three.
  void add_integral(int column, int row, const ColorPowers& moments, double* out) const;
  /// Adds the means over cells [begin, end) times a share to `out`, the values of the first one on.
  void add_means(int begin, int end, int row, double share, double* out) const;

 private:
  bool is_linear() const {
    return layer_.paint.kind == Paint::Kind::kLinear && layer_.veils.empty();
  }
  ChannelValues at(const Point2& point) const;
  Point2 center_of(int column, int row) const {
    return {filter_.to_pixel(column + 0.5), filter_.to_pixel(row + 0.5)};
  }
  void node_powers(int column, int row, std::array<ColorPowers, kMaxChannels>* out) const;

  const RasterLayer& layer_;
  const CellFilter& filter_;
  std::optional<RoundGradient> round_;
};

}  // namespace prefilter
