// SPDX-License-Identifier: GPL-3.0-or-later

// Radix sort of integers by some of their bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace prefilter {

/// Stable sort by the bits from `low` up to, but excluding, `high`. `other` is scratch memory.
inline void radix_sort(std::vector<std::uint64_t>* values, int low, int high,
                       std::vector<std::uint64_t>* other) {
  constexpr int kMaxDigitBits = 11;
  const int passes = (high - low + kMaxDigitBits - 1) / kMaxDigitBits;
  other->resize(values->size());
  for (int pass = 0; pass < passes; ++pass) {
    const int begin = low + (high - low) * pass / passes;
    const int bits = low + (high - low) * (pass + 1) / passes - begin;
    const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
    std::array<std::size_t, std::size_t{1} << kMaxDigitBits> places{};
    for (const std::uint64_t value : *values) ++places[(value >> begin) & mask];
    std::size_t next = 0;
    for (std::size_t digit = 0; digit <= mask; ++digit) {
      const std::size_t count = places[digit];
      places[digit] = next;
      next += count;
    }
    for (const std::uint64_t value : *values) (*other)[places[(value >> begin) & mask]++] = value;
    values->swap(*other);
  }
}

}  // namespace prefilter
