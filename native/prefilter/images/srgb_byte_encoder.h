// SPDX-License-Identifier: GPL-3.0-or-later

// Fast encoding of scene-linear values as bytes of sRGB.
#pragma once

#include <array>
#include <cstdint>

namespace prefilter {

/// The byte nearest to linear_to_srgb, which is never computed: where one byte ends and the next
/// begins is known. Values beyond [0, 1] become 0 or 255, and so do those that are no numbers, 0.
class SrgbByteEncoder {
 public:
  static const SrgbByteEncoder& instance();

  std::uint8_t operator()(float linear) const {
    if (!(linear > 0.0F)) return 0;
    if (linear >= 1.0F) return kLast;
    // Bytes are at least 3e-4 wide, more than a step: no more than one begins within it.
    const int first = first_[static_cast<int>(linear * kSteps)];
    return static_cast<std::uint8_t>(first + (linear >= begin_[first + 1] ? 1 : 0));
  }

 private:
  static constexpr int kSteps = 4096;
  static constexpr int kLast = 255;

  SrgbByteEncoder();

  std::array<float, kLast + 2> begin_{};      // the least value of each byte; none of 256
  std::array<std::uint8_t, kSteps> first_{};  // the byte where a step begins
};

}  // namespace prefilter
