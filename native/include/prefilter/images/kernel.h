// SPDX-License-Identifier: GPL-3.0-or-later

// Filter kernels in one dimension: even functions, piecewise polynomials, of integral 1.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace prefilter {

class Kernel {
 public:
  static constexpr int kMostDegree = 7;

  /// A piece, over its width, as t goes from 0 to 1: the sum of coefficient k times t^k.
  using Piece = std::array<double, kMostDegree + 1>;

  /// The kernel whose pieces interpolate an even function at Chebyshev's extreme points, their ends
  /// among them, scaled to an integral of 1. `function` is asked for x from 0 to the radius, a
  /// multiple of half a piece's width; where it is a polynomial of that degree on every piece, so
  /// is the kernel, but for the scale.
  Kernel(std::string_view name, double radius, double piece_width, int degree,
         double (*function)(double));

  std::string_view name() const { return name_; }
  /// Half the width of the support.
  double radius() const { return radius_; }
  /// The pieces, from -radius() on, each piece_width() wide: 1, or 1/2. So they lie on a grid of
  /// texels or half texels.
  std::span<const Piece> pieces() const { return pieces_; }
  double piece_width() const { return piece_width_; }
  /// The highest of the pieces' degrees. Kernels of degree 0 jump; all others are continuous, but
  /// for a step of 3.5e-6 where "gaussian" ends.
  int degree() const { return degree_; }

  /// The kernel at x; 0 outside of its support.
  double value(double x) const;

  /// Its integral up to x: 0 before its support, 1 behind.
  double integral(double x) const;

 private:
  // The piece at x, which is inside of the support, and how far across it x lies.
  std::size_t piece_at(double x, double* t) const;

  std::string_view name_;
  double radius_;
  double piece_width_;
  int degree_;
  std::vector<Piece> pieces_;
  std::vector<double> integrals_;  // up to where each piece begins
};

/// All kernels there are, by a table in kernel.cpp: what takes the name of a kernel takes any of
/// these.
std::span<const Kernel> kernels();

/// The kernel of a name, or none.
const Kernel* find_kernel(std::string_view name);

/// The same for an argument called filter; throws Error where there is none.
const Kernel& kernel_named(std::string_view name);

/// The one that the means over texels are.
const Kernel& box_kernel();

/// The weights of source texels first, first + 1, ... in a sum.
struct Taps {
  int first = 0;
  std::vector<double> weights;  // sum to 1
};

/// Taps of a kernel at `center`, in texels of the source, where its unit is `width` texels wide: it
/// is taken at the texels' centers, and never narrower than they are. Where it jumps it is
/// integrated over each texel, at any width: the box gives the mean over its square.
Taps kernel_taps(const Kernel& kernel, double center, double width);

/// Taps of target texel `target` where a target texel is as wide as `ratio` source texels.
Taps resampling_taps(const Kernel& kernel, double ratio, int target);

}  // namespace prefilter
