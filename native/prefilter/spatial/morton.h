// The Morton curve: the order of the cells of an octree.
#pragma once

#include <array>
#include <cassert>
#include <cstdint>

namespace prefilter {

/// The bits of a number below 1024, with two zeros between them.
constexpr std::uint32_t spread_bits(std::uint32_t n) {
  n = (n | (n << 16U)) & 0x030000FFU;
  n = (n | (n << 8U)) & 0x0300F00FU;
  n = (n | (n << 4U)) & 0x030C30C3U;
  n = (n | (n << 2U)) & 0x09249249U;
  return n;
}

/// Where a cell is along the curve; x has the lowest bits. Coordinates from 0 to 1023.
inline std::uint32_t morton_index(const std::array<int, 3>& cell) {
  assert(cell[0] >= 0 && cell[1] >= 0 && cell[2] >= 0);
  assert(cell[0] < 1024 && cell[1] < 1024 && cell[2] < 1024);
  return spread_bits(static_cast<std::uint32_t>(cell[0])) |
         (spread_bits(static_cast<std::uint32_t>(cell[1])) << 1U) |
         (spread_bits(static_cast<std::uint32_t>(cell[2])) << 2U);
}

/// Every third bit of a number, close together: the inverse of spread_bits.
constexpr std::uint32_t gather_bits(std::uint32_t n) {
  n &= 0x09249249U;
  n = (n | (n >> 2U)) & 0x030C30C3U;
  n = (n | (n >> 4U)) & 0x0300F00FU;
  n = (n | (n >> 8U)) & 0x030000FFU;
  n = (n | (n >> 16U)) & 0x000003FFU;
  return n;
}

/// The cell at a place along the curve.
inline std::array<int, 3> morton_cell(std::uint32_t index) {
  return {static_cast<int>(gather_bits(index)), static_cast<int>(gather_bits(index >> 1U)),
          static_cast<int>(gather_bits(index >> 2U))};
}

}  // namespace prefilter
