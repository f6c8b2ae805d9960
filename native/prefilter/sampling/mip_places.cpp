// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/mip_places.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "prefilter/base/lanes.h"

namespace prefilter {
namespace {

constexpr int kLanes = 4;

using FourPlaces = Vector<std::int32_t, kLanes>;

/// Base-2 logarithm of values in (1, 2]: an odd polynomial of t = (m - 1) / (m + 1) with five terms
/// that minimize the largest relative error, 4e-9 before rounding.
inline Lanes log2_of_mantissas(Lanes m) {
  const Lanes t = (m - 1.0F) / (m + 1.0F);
  const Lanes square = t * t;
  Lanes sum = 0.406527443F * square + 0.403386229F;
  sum = sum * square + 0.577437396F;
  sum = sum * square + 0.961791616F;
  sum = sum * square + 2.88539009F;
  return t * sum;
}

inline void place_four(const double* scales, std::int32_t coarsest, int* cell_levels, float* f) {
  Lanes scale{};
  for (int i = 0; i < kLanes; ++i) scale[i] = static_cast<float>(scales[i]);
  scale = lane_max(scale, Lanes{} + 1.0F);
  const FourPlaces bits = std::bit_cast<FourPlaces>(scale);
  // Powers of 2 belong to the interval below them.
  const FourPlaces exponent = ((bits - 1) >> 23) - 127;
  const Lanes mantissa = std::bit_cast<Lanes>(bits - (exponent << 23));
  const Lanes fraction = lane_min(log2_of_mantissas(mantissa), Lanes{} + 1.0F);
  const FourPlaces magnifies = exponent < 0;
  const FourPlaces is_coarser = exponent > coarsest;
  const FourPlaces level =
      select(magnifies, FourPlaces{}, select(is_coarser, FourPlaces{} + coarsest, exponent) + 1);
  const Lanes share = select(magnifies, Lanes{}, select(is_coarser, Lanes{} + 1.0F, fraction));
  std::memcpy(cell_levels, &level, sizeof level);
  std::memcpy(f, &share, sizeof share);
}

}  // namespace

void place_between_levels(const double* scales, int count, int levels, int* cell_levels, float* f) {
  if (levels == 1) {
    std::fill_n(cell_levels, count, 0);
    std::fill_n(f, count, 0.0F);
    return;
  }
  const std::int32_t coarsest = levels - 2;
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    place_four(scales + i, coarsest, cell_levels + i, f + i);
  }
  if (i == count) return;
  std::array<double, kLanes> last_scales{};
  std::array<int, kLanes> last_levels;
  std::array<float, kLanes> last_f;
  std::copy(scales + i, scales + count, last_scales.begin());
  place_four(last_scales.data(), coarsest, last_levels.data(), last_f.data());
  std::copy_n(last_levels.begin(), count - i, cell_levels + i);
  std::copy_n(last_f.begin(), count - i, f + i);
}

}  // namespace prefilter
