// SPDX-License-Identifier: GPL-3.0-or-later

// The closest blocks of ETC2's colors that a search finds, mode by mode (Khronos Data Format 1.3,
// chapter 21): more of them than etcpak looks at.
#pragma once

#include <array>
#include <cstdint>

namespace prefilter {

/// Red, green and blue.
using EtcColor = std::array<int, 3>;

/// The texels of a block, column by column, as blocks number them.
struct EtcTexels {
  static constexpr int kCount = 16;
  std::array<EtcColor, kCount> colors;
  std::array<int, kCount> weights;  // 1 inside of the image, 0 beyond its edge
};

struct EtcBlock {
  std::uint64_t bits;  // the first byte is the highest
  int error;           // the sum of squares over red, green and blue; more than possible for none
};

/// Two halves, each with a color of its own and one table of lighter and darker ones.
EtcBlock search_etc_halves(const EtcTexels& texels);

/// Two colors, and lighter and darker ones of the second or of both: T and H.
EtcBlock search_etc_paints(const EtcTexels& texels);

/// A plane through the colors of three corners; a level one where all texels are of one color.
EtcBlock search_etc_plane(const EtcTexels& texels);

inline int square(int value) { return value * value; }

/// No error is larger.
inline constexpr int kLargestError = EtcTexels::kCount * 3 * 255 * 255;

/// What is this far off to begin with is not refined, where something is `least` off.
inline int hopeless(int least) { return least > kLargestError / 4 ? kLargestError : 4 * least; }

inline EtcBlock closer(const EtcBlock& one, const EtcBlock& other) {
  return other.error < one.error ? other : one;
}

/// The bit that keeps a sum of `base`, of four bits below it, and a signed `step` of three bits
/// within five bits.
inline std::uint64_t bit_within(int base, int step) {
  return base + (step >= 4 ? step - 8 : step) < 0 ? 1 : 0;
}

/// Four bits around two numbers of two bits each that make such a sum leave five bits, which
/// selects a mode: the upper three, and the sign of the step.
struct LeavingBits {
  std::uint64_t upper, sign;
};
inline LeavingBits bits_beyond(int base, int step) {
  return base + step >= 4 ? LeavingBits{7, 0} : LeavingBits{0, 1};
}

}  // namespace prefilter
