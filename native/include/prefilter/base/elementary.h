// SPDX-License-Identifier: GPL-3.0-or-later

// Elementary functions with bitwise the same results on all platforms, unlike those of C libraries,
// which also differ between processors. Errors are below 1 unit in the last place.
#pragma once

#include <algorithm>
#include <cmath>

extern "C" {
double prefilter_acos(double x);
double prefilter_atan2(double y, double x);
double prefilter_cbrt(double x);
double prefilter_cos(double x);
double prefilter_exp(double x);
double prefilter_exp2(double x);
double prefilter_expm1(double x);
double prefilter_log(double x);
double prefilter_log2(double x);
double prefilter_pow(double x, double y);
float prefilter_powf(float x, float y);
double prefilter_sin(double x);
double prefilter_tan(double x);
}

namespace prefilter::elementary {

inline double acos(double x) { return prefilter_acos(x); }
inline double atan2(double y, double x) { return prefilter_atan2(y, x); }
inline double cbrt(double x) { return prefilter_cbrt(x); }
inline double cos(double x) { return prefilter_cos(x); }
inline double exp(double x) { return prefilter_exp(x); }
inline double exp2(double x) { return prefilter_exp2(x); }
inline double expm1(double x) { return prefilter_expm1(x); }
inline double log(double x) { return prefilter_log(x); }
inline double log2(double x) { return prefilter_log2(x); }
inline double pow(double x, double y) { return prefilter_pow(x, y); }
inline float pow(float x, float y) { return prefilter_powf(x, y); }
inline double sin(double x) { return prefilter_sin(x); }
inline double tan(double x) { return prefilter_tan(x); }

/// The length of (x, y, z), even if its square is beyond the range of doubles.
inline double hypot(double x, double y, double z = 0.0) {
  const double square = x * x + y * y + z * z;
  if (square >= 0x1p-900 && square <= 0x1p900) return std::sqrt(square);
  const double size = std::max({std::abs(x), std::abs(y), std::abs(z)});
  if (size == 0.0 || std::isinf(size)) return size + square;
  const double a = x / size;
  const double b = y / size;
  const double c = z / size;
  return size * std::sqrt(a * a + b * b + c * c);
}

}  // namespace prefilter::elementary
