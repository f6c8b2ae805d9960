#include "prefilter/filters/kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

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

Taps downsampling_taps(Kernel kernel, double scale, int target) {
  const double centre = (target + 0.5) * scale;
  const double reach = kernel_radius(kernel) * scale;
  std::vector<double> values;
  Taps taps;
  if (kernel == Kernel::kBox) {
    // Scales are ratios of whole numbers: an edge this close to a texel's is the texel's.
    constexpr double kOnEdge = 1e-9;
    taps.first = static_cast<int>(std::floor(centre - reach + kOnEdge));
    const int end = static_cast<int>(std::ceil(centre + reach - kOnEdge));
    for (int i = taps.first; i < end; ++i) {
      values.push_back(std::min(i + 1.0, centre + reach) - std::max<double>(i, centre - reach));
    }
  } else {
    taps.first = static_cast<int>(std::ceil(centre - reach - 0.5));
    const int last = static_cast<int>(std::floor(centre + reach - 0.5));
    for (int i = taps.first; i <= last; ++i) {
      values.push_back(kernel_value(kernel, (i + 0.5 - centre) / scale));
    }
  }
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  for (const double value : values) taps.weights.push_back(value / sum);
  return taps;
}

}  // namespace prefilter
