// SPDX-License-Identifier: GPL-3.0-or-later

// Converts values from 0 to 1 to bytes.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "prefilter/base/vectors.h"

namespace prefilter {

/// Converts a value from 0..1 to 0..255: rounded to nearest, ties to even, and clamped. NaN becomes
/// 0.
template <typename T>
std::uint8_t unit_byte(T value) {
  const auto number = static_cast<float>(value);
  const float above = number > 0.0F ? number : 0.0F;
  return static_cast<std::uint8_t>(std::lrint(255.0F * (above < 1.0F ? above : 1.0F)));
}

#if defined(PREFILTER_SSE4_1)
inline __m128 load_floats(const float* from) { return _mm_loadu_ps(from); }
inline __m128 load_floats(const double* from) {
  return _mm_movelh_ps(_mm_cvtpd_ps(_mm_loadu_pd(from)), _mm_cvtpd_ps(_mm_loadu_pd(from + 2)));
}
#endif

/// Converts many values.
template <typename T>
void unit_bytes(std::span<const T> values, std::uint8_t* out) {
  std::size_t i = 0;
#if defined(PREFILTER_SSE4_1)
  const auto four = [&](std::size_t at) {
    // Negative values and NaN remain, and are clamped to 0 by packing.
    const __m128 below = _mm_min_ps(_mm_set1_ps(1.0F), load_floats(values.data() + at));
    return _mm_cvtps_epi32(_mm_mul_ps(below, _mm_set1_ps(255.0F)));
  };
  for (; i + 16 <= values.size(); i += 16) {
    const __m128i low = _mm_packs_epi32(four(i), four(i + 4));
    const __m128i high = _mm_packs_epi32(four(i + 8), four(i + 12));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out + i), _mm_packus_epi16(low, high));
  }
#endif
  for (; i < values.size(); ++i) out[i] = unit_byte(values[i]);
}

}  // namespace prefilter
