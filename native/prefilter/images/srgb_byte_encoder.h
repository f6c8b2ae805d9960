// SPDX-License-Identifier: GPL-3.0-or-later

// Fast sRGB encoding of scene-linear values as bytes.
#pragma once

#include <array>
#include <cstdint>

namespace prefilter {

/// The byte nearest to linear_to_srgb, from a table of the smallest value of each byte. Values
/// outside [0, 1] become 0 or 255, and NaN becomes 0.
class SrgbByteEncoder {
 public:
  static const SrgbByteEncoder& instance();

  std::uint8_t operator()(float linear) const {
    if (!(linear > 0.0F)) return 0;
    if (linear >= 1.0F) return kLast;
    // Bytes span at least 3e-4, more than a step, so at most one of them begins within a step.
    const int first = first_[static_cast<int>(linear * kSteps)];
    return static_cast<std::uint8_t>(first + (linear >= begin_[first + 1] ? 1 : 0));
  }

 private:
  static constexpr int kSteps = 4096;
  static constexpr int kLast = 255;

  SrgbByteEncoder();

  std::array<float, kLast + 2> begin_{};      // the smallest value of each byte
  std::array<std::uint8_t, kSteps> first_{};  // the byte at the start of each step
};

}  // namespace prefilter
