// SPDX-License-Identifier: GPL-3.0-or-later

// One-dimensional filter kernels: even piecewise polynomials with integral 1.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace prefilter {

class Kernel {
 public:
  static constexpr int kMostDegree = 7;

  /// Coefficients of a piece: the sum of coefficient k times t^k, with t from 0 to 1 over its
  /// width.
  using Piece = std::array<double, kMostDegree + 1>;

  /// A kernel whose pieces interpolate an even function at Chebyshev extreme points, which include
  /// their ends, scaled to an integral of 1. `function` is evaluated for x from 0 to the radius, a
  /// multiple of half a piece's width. If it is a polynomial of that degree on every piece, the
  /// kernel is exact up to the scale.
  Kernel(std::string_view name, double radius, double piece_width, int degree,
         double (*function)(double));

  std::string_view name() const { return name_; }
  /// Half the width of the support.
  double radius() const { return radius_; }
  /// The pieces from -radius() on, each piece_width() wide: 1 or 1/2. So they start at whole texels
  /// or half texels.
  std::span<const Piece> pieces() const { return pieces_; }
  double piece_width() const { return piece_width_; }
  /// The highest degree of the pieces. Kernels of degree 0 are discontinuous; all others are
  /// continuous, except for a step of 3.5e-6 where "gaussian" ends.
  int degree() const { return degree_; }

  /// The kernel at x; 0 outside its support.
  double value(double x) const;

  /// The integral up to x: 0 before the support, 1 behind it.
  double integral(double x) const;

 private:
  // The piece at x, which must be inside the support, and the position t in it.
  std::size_t piece_at(double x, double* t) const;

  std::string_view name_;
  double radius_;
  double piece_width_;
  int degree_;
  std::vector<Piece> pieces_;
  std::vector<double> integrals_;  // up to the start of each piece
};

/// All kernels, from a table in kernel.cpp.
std::span<const Kernel> kernels();

/// The kernel with a name, or nullptr.
const Kernel* find_kernel(std::string_view name);

/// The same for an argument called filter; throws Error for an unknown name.
const Kernel& kernel_named(std::string_view name);

/// The kernel of means over texels.
const Kernel& box_kernel();

/// Weights of the source texels first, first + 1, ... in a sum.
struct Taps {
  int first = 0;
  std::vector<double> weights;  // sum to 1
};

/// Taps of a kernel centered at `center`, in texels of the source, with a unit of `width` texels
/// but at least 1. The kernel is evaluated at texel centers. Discontinuous kernels are integrated
/// over each texel: the box gives the exact mean.
Taps kernel_taps(const Kernel& kernel, double center, double width);

/// Taps of target texel `target`, which is `ratio` source texels wide.
Taps resampling_taps(const Kernel& kernel, double ratio, int target);

}  // namespace prefilter
