#include "prefilter/filters/kernel.h"

#include <cmath>
#include <numbers>

namespace prefilter {
namespace {

double sinc(double x) {
  if (std::abs(x) < 1e-9) return 1.0;
  const double angle = std::numbers::pi * x;
  return std::sin(angle) / angle;
}

}  // namespace

double kernel_radius(Kernel kernel) {
  switch (kernel) {
    case Kernel::kBox:
      return 0.5;
    case Kernel::kTent:
      return 1.0;
    case Kernel::kLanczos3:
      return 3.0;
  }
  return 0.0;
}

double kernel_value(Kernel kernel, double x) {
  if (std::abs(x) > kernel_radius(kernel)) return 0.0;
  switch (kernel) {
    case Kernel::kBox:
      return 1.0;
    case Kernel::kTent:
      return 1.0 - std::abs(x);
    case Kernel::kLanczos3:
      return sinc(x) * sinc(x / 3.0);
  }
  return 0.0;
}

Taps downsampling_taps(Kernel kernel, int factor) {
  // Target texel 0 has its centre at factor / 2 in source texels, source texel i at i + 1/2.
  const double centre = 0.5 * factor;
  const double reach = kernel_radius(kernel) * factor;
  Taps taps;
  taps.first = static_cast<int>(std::ceil(centre - reach - 0.5));
  const int last = static_cast<int>(std::floor(centre + reach - 0.5));
  std::vector<double> values;
  double sum = 0.0;
  for (int i = taps.first; i <= last; ++i) {
    values.push_back(kernel_value(kernel, (i + 0.5 - centre) / factor));
    sum += values.back();
  }
  for (const double value : values) taps.weights.push_back(value / sum);
  return taps;
}

}  // namespace prefilter
