// SPDX-License-Identifier: GPL-3.0-or-later

// Searches the ETC2 color modes for the closest blocks (Khronos Data Format 1.3, chapter 21), more
// thoroughly than etcpak.
#pragma once

#include <array>
#include <cstdint>

namespace prefilter {

/// Red, green and blue.
using EtcColor = std::array<int, 3>;

/// The texels of a block, column by column like their indices in the format.
struct EtcTexels {
  static constexpr int kCount = 16;
  std::array<EtcColor, kCount> colors;
  std::array<int, kCount> weights;  // 1 inside the image, 0 beyond its edge
};

struct EtcBlock {
  std::uint64_t bits;  // the first byte is the most significant
  int error;           // sum of squares over red, green and blue; above kLargestError for no block
};

/// Two halves, each with a base color and a table of lighter and darker variants: individual and
/// differential mode.
EtcBlock search_etc_halves(const EtcTexels& texels);

/// Two colors, and lighter and darker variants of the second or of both: modes T and H.
EtcBlock search_etc_paints(const EtcTexels& texels);

/// A plane through the colors of three corners; flat for blocks of a single color.
EtcBlock search_etc_plane(const EtcTexels& texels);

inline int square(int value) { return value * value; }

/// The largest possible error.
inline constexpr int kLargestError = EtcTexels::kCount * 3 * 255 * 255;

/// Candidates with a larger initial error than this are not refined if the best error is `least`.
inline int max_initial_error(int least) {
  return least > kLargestError / 4 ? kLargestError : 4 * least;
}

inline EtcBlock closer(const EtcBlock& one, const EtcBlock& other) {
  return other.error < one.error ? other : one;
}

/// The bit above a four-bit `base` that keeps the sum of the five-bit number and a signed three-bit
/// `step` in range.
inline std::uint64_t bit_within(int base, int step) {
  return base + (step >= 4 ? step - 8 : step) < 0 ? 1 : 0;
}

/// The bits around a two-bit base and a two-bit step that make their sum overflow five bits, which
/// selects a mode: the upper three bits of the base, and the sign of the step.
struct OverflowBits {
  std::uint64_t upper, sign;
};
inline OverflowBits overflow_bits(int base, int step) {
  return base + step >= 4 ? OverflowBits{7, 0} : OverflowBits{0, 1};
}

}  // namespace prefilter
