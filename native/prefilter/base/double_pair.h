// SPDX-License-Identifier: GPL-3.0-or-later

// SIMD pairs of doubles and quadruples of integers.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "prefilter/base/vectors.h"

namespace prefilter {

using DoublePair = Vector<double, 2>;
/// Arithmetic is modulo 2^32.
using IntFour = Vector<std::uint32_t, 4>;

inline DoublePair pair_of(double value) { return DoublePair{value, value}; }

inline DoublePair load_pair(const double* from) {
  DoublePair values;
  std::memcpy(&values, from, sizeof(values));
  return values;
}

inline void store_pair(double* to, DoublePair values) { std::memcpy(to, &values, sizeof(values)); }

inline IntFour load_four(const std::uint32_t* from) {
  IntFour values;
  std::memcpy(&values, from, sizeof(values));
  return values;
}

inline void store_four(std::uint32_t* to, IntFour values) {
  std::memcpy(to, &values, sizeof(values));
}

#if defined(PREFILTER_SSE4_1)
/// Returns the second operand if either is NaN.
inline DoublePair lower(DoublePair a, DoublePair b) { return _mm_min_pd(a, b); }
inline DoublePair higher(DoublePair a, DoublePair b) { return _mm_max_pd(a, b); }
inline DoublePair floor(DoublePair a) { return _mm_floor_pd(a); }
inline DoublePair sqrt(DoublePair a) { return _mm_sqrt_pd(a); }
/// Bit mask of the elements whose magnitude is not at most `most`.
inline int farther(DoublePair a, double most) {
  const __m128d size = _mm_andnot_pd(_mm_set1_pd(-0.0), a);
  return _mm_movemask_pd(_mm_cmpnle_pd(size, _mm_set1_pd(most)));
}
/// Rounds to nearest, ties to even, into the first two elements; 2^31 if out of range. The others
/// are 0.
inline IntFour round_to_int(DoublePair a) { return reinterpret_cast<IntFour>(_mm_cvtpd_epi32(a)); }
#else
inline DoublePair lower(DoublePair a, DoublePair b) {
  return DoublePair{a[0] < b[0] ? a[0] : b[0], a[1] < b[1] ? a[1] : b[1]};
}
inline DoublePair higher(DoublePair a, DoublePair b) {
  return DoublePair{a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1]};
}
inline DoublePair floor(DoublePair a) { return DoublePair{std::floor(a[0]), std::floor(a[1])}; }
inline DoublePair sqrt(DoublePair a) { return DoublePair{std::sqrt(a[0]), std::sqrt(a[1])}; }
inline int farther(DoublePair a, double most) {
  return (std::abs(a[0]) <= most ? 0 : 1) + (std::abs(a[1]) <= most ? 0 : 2);
}
inline IntFour round_to_int(DoublePair a) {
  const auto rounded = [](double value) {
    // The result of the x86 instruction if out of range.
    return std::abs(value) < 0x1p31 ? static_cast<std::uint32_t>(std::lrint(value)) : 1U << 31;
  };
  return IntFour{rounded(a[0]), rounded(a[1]), 0, 0};
}
#endif

/// Rounds to nearest, ties to even, modulo 2^32. The value must be within 2^63.
inline std::uint32_t to_steps(double value) {
#if defined(PREFILTER_SSE4_1)
  return static_cast<std::uint32_t>(_mm_cvtsd_si64(_mm_set_sd(value)));
#else
  return static_cast<std::uint32_t>(std::llrint(value));
#endif
}

/// Converts 16 numbers, as signed integers times a factor, to bytes: rounded to nearest and clamped
/// to 0 and 255.
#if defined(PREFILTER_SSE4_1)
inline void store_bytes(std::uint8_t* to, const std::uint32_t* values, float factor) {
  const auto four = [&](int i) {
    const __m128i integers = reinterpret_cast<__m128i>(load_four(values + 4 * i));
    return _mm_cvtps_epi32(_mm_mul_ps(_mm_cvtepi32_ps(integers), _mm_set1_ps(factor)));
  };
  const __m128i low = _mm_packs_epi32(four(0), four(1));
  const __m128i high = _mm_packs_epi32(four(2), four(3));
  const __m128i bytes = _mm_packus_epi16(low, high);
  std::memcpy(to, &bytes, sizeof(bytes));
}
#else
inline void store_bytes(std::uint8_t* to, const std::uint32_t* values, float factor) {
  for (int i = 0; i < 16; ++i) {
    const float value = factor * static_cast<float>(static_cast<std::int32_t>(values[i]));
    to[i] = static_cast<std::uint8_t>(std::lrint(std::fmin(std::fmax(value, 0.0F), 255.0F)));
  }
}
#endif

/// The first two elements of each.
inline IntFour joined(IntFour low, IntFour high) { return shuffle<0, 1, 4, 5>(low, high); }

}  // namespace prefilter
