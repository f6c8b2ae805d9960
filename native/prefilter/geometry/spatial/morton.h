// SPDX-License-Identifier: GPL-3.0-or-later

// The Morton curve, which orders the cells of an octree.
#pragma once

#include <array>
#include <cassert>
#include <cstdint>

namespace prefilter {

/// Bits per axis: the curve distinguishes 2^21 cells along each axis.
inline constexpr int kMortonBits = 21;

/// Inserts two zeros between the bits of a number below 2^21.
constexpr std::uint64_t spread_bits(std::uint64_t n) {
  n = (n | (n << 32U)) & 0x001F00000000FFFFU;
  n = (n | (n << 16U)) & 0x001F0000FF0000FFU;
  n = (n | (n << 8U)) & 0x100F00F00F00F00FU;
  n = (n | (n << 4U)) & 0x10C30C30C30C30C3U;
  n = (n | (n << 2U)) & 0x1249249249249249U;
  return n;
}

/// Extracts every third bit of a number: the inverse of spread_bits.
constexpr std::uint64_t gather_bits(std::uint64_t n) {
  n &= 0x1249249249249249U;
  n = (n | (n >> 2U)) & 0x10C30C30C30C30C3U;
  n = (n | (n >> 4U)) & 0x100F00F00F00F00FU;
  n = (n | (n >> 8U)) & 0x001F0000FF0000FFU;
  n = (n | (n >> 16U)) & 0x001F00000000FFFFU;
  n = (n | (n >> 32U)) & 0x00000000001FFFFFU;
  return n;
}

/// Index of a cell on the curve, with x in the lowest bits. Coordinates are from 0 to 2^21 - 1.
inline std::uint64_t morton_index(const std::array<int, 3>& cell) {
  std::uint64_t index = 0;
  for (int a = 0; a < 3; ++a) {
    assert(cell[a] >= 0 && cell[a] < 1 << kMortonBits);
    index |= spread_bits(static_cast<std::uint64_t>(cell[a])) << a;
  }
  return index;
}

/// The cell at an index on the curve.
inline std::array<int, 3> morton_cell(std::uint64_t index) {
  return {static_cast<int>(gather_bits(index)), static_cast<int>(gather_bits(index >> 1U)),
          static_cast<int>(gather_bits(index >> 2U))};
}

}  // namespace prefilter
