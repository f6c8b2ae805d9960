// A paint as a polynomial on each cell.
#pragma once

#include <array>

#include "prefilter/raster/cell_filter.h"
#include "prefilter/raster/paint.h"

namespace prefilter {

/// Of 1, u, v, u^2, u v, v^2, in the coordinates from a cell's center.
using ColorPowers = std::array<double, 6>;

/// The exponents of u and v in ColorPowers.
inline constexpr std::array<std::array<int, 2>, 6> kColorExponents = {
    {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}}};

class LocalColor {
 public:
  /// Of a paint whose kind is kLinear or kRadialStops. Both must outlive this.
  LocalColor(const Paint& paint, const CellFilter& filter) : paint_(paint), filter_(filter) {}

  int channels() const { return paint_.channels; }
  /// 1 for linear colors, 2 for others.
  int degree() const { return paint_.kind == Paint::Kind::kLinear ? 1 : 2; }
  /// For each channel. Linear colors are what they are; others the polynomial that is nearest in
  /// the mean square, by Gauss's rule of three points along each axis.
  void powers(int column, int row, std::array<ColorPowers, kMaxChannels>* out) const;

 private:
  const Paint& paint_;
  const CellFilter& filter_;
};

}  // namespace prefilter
