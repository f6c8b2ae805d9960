// SPDX-License-Identifier: GPL-3.0-or-later

// The windowed radial low-pass filter of section 1.1.
#pragma once

namespace prefilter {

/// J1, the Bessel function of the first kind of order 1, accurate to 1e-14. (libc++ lacks
/// std::cyl_bessel_j.)
double bessel_j1(double x);

/// jinc(r) sinc(r / radius), scaled to an integral of 1 over the plane, in texels. jinc(r) = J1(pi
/// r) / (pi r) is the ideal radial low-pass filter of section 1.1, which passes frequencies up to
/// half a cycle per texel in every direction. The window sinc(x) = sin(pi x) / (pi x), as in figure
/// 1.6, has its first zero at the radius.
class WindowedJinc {
 public:
  /// The radius is positive, usually 2 or 3. Construction integrates numerically: reuse the object.
  explicit WindowedJinc(double radius);

  double radius() const { return radius_; }

  /// The filter at a distance from its center; 0 from the radius on.
  double operator()(double distance) const;

 private:
  double radius_;
  double scale_ = 1.0;
};

/// A single value of the filter.
double windowed_jinc(double distance, double radius);

}  // namespace prefilter
