#include "prefilter/sampling/mip_places.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace prefilter {
namespace {

/// The logarithm to base 2 of a value in (1, 2]. As an odd function of t = (m - 1) / (m + 1) it
/// needs five terms, which minimize the largest relative error: 4e-9, before rounding.
inline float log2_of_mantissa(float m) {
  const float t = (m - 1.0F) / (m + 1.0F);
  const float square = t * t;
  float sum = 0.406527443F;
  sum = sum * square + 0.403386229F;
  sum = sum * square + 0.577437396F;
  sum = sum * square + 0.961791616F;
  sum = sum * square + 2.88539009F;
  return t * sum;
}

}  // namespace

void place_between_levels(const double* scales, int count, int levels, int* cell_levels, float* f) {
  const std::int32_t coarsest = levels - 2;
  for (int i = 0; i < count; ++i) {
    const float scale = std::max(static_cast<float>(scales[i]), 1.0F);
    const auto bits = std::bit_cast<std::int32_t>(scale);
    // Powers of 2 count to the interval below them.
    const std::int32_t exponent = ((bits - 1) >> 23) - 127;
    const float mantissa = std::bit_cast<float>(bits - exponent * (1 << 23));
    const float fraction = std::min(log2_of_mantissa(mantissa), 1.0F);
    const bool magnifies = scale == 1.0F || coarsest < 0;
    cell_levels[i] = magnifies ? 0 : std::min(exponent, coarsest) + 1;
    f[i] = magnifies ? 0.0F : exponent > coarsest ? 1.0F : fraction;
  }
}

}  // namespace prefilter
