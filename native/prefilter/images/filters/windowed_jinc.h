// SPDX-License-Identifier: GPL-3.0-or-later

// The radial low-pass filter of section 1.1, windowed.
#pragma once

namespace prefilter {

/// J1, the Bessel function of the first kind of order 1, to 1e-14. (libc++ has no
/// std::cyl_bessel_j.)
double bessel_j1(double x);

/// jinc(r) sinc(r / radius), scaled to an integral of 1 over the plane: jinc(r) = J1(pi r) / (pi r)
/// is the ideal radial low-pass filter of section 1.1, which passes frequencies up to half a cycle
/// per texel in every direction, and sinc(x) = sin(pi x) / (pi x), whose main lobe ends at the
/// radius, windows it as in figure 1.6. Lengths are in texels.
class WindowedJinc {
 public:
  /// The radius is positive; 2 and 3 are usual. This integrates: keep the object.
  explicit WindowedJinc(double radius);

  double radius() const { return radius_; }

  /// The filter at a distance from its center; 0 from the radius on.
  double operator()(double distance) const;

 private:
  double radius_;
  double scale_ = 1.0;
};

/// The same where only one value is wanted.
double windowed_jinc(double distance, double radius);

}  // namespace prefilter
