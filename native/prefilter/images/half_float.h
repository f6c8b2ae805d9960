// SPDX-License-Identifier: GPL-3.0-or-later

// 16-bit floats (IEEE 754 binary16).
#pragma once

#include <bit>
#include <cstdint>

namespace prefilter {

inline constexpr float kLargestHalf = 65504.0F;

/// The bits of the nearest half float, ties to even; infinite beyond the range.
inline std::uint16_t half_bits(float value) {
  constexpr std::uint32_t kInfinity = 0x7f800000;
  constexpr std::uint32_t kTooLarge = 0x477ff000;        // 65520, halfway past the largest
  constexpr std::uint32_t kSmallestNormal = 0x38800000;  // 2^-14
  constexpr std::uint32_t kRebias = (127U - 15U) << 23;
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const auto sign = static_cast<std::uint16_t>((bits >> 16) & 0x8000U);
  const std::uint32_t magnitude = bits & 0x7fffffffU;
  if (magnitude > kInfinity) return sign | 0x7e00;
  if (magnitude >= kTooLarge) return sign | 0x7c00;
  if (magnitude < kSmallestNormal) {
    // The sum has the precision of a subnormal half in its lowest bits; the processor rounds it.
    const float shifted = std::bit_cast<float>(magnitude) + 0.5F;
    return static_cast<std::uint16_t>(
        sign | (std::bit_cast<std::uint32_t>(shifted) - std::bit_cast<std::uint32_t>(0.5F)));
  }
  const std::uint32_t odd = (magnitude >> 13) & 1U;
  return static_cast<std::uint16_t>(sign | ((magnitude - kRebias + 0xfffU + odd) >> 13));
}

}  // namespace prefilter
