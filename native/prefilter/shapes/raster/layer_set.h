// SPDX-License-Identifier: GPL-3.0-or-later

// A set of layers, searchable from the top.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace prefilter {

/// A set of integers below a fixed count: a hierarchy of bit sets, in which each bit tells whether
/// a word of the level below is nonzero.
class LayerSet {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;

  explicit LayerSet(std::size_t count) {
    do {
      count = count / 64 + 1;
      levels_.emplace_back(count, 0);
    } while (count > 1);
  }

  void insert(std::uint32_t layer) {
    for (auto& words : levels_) {
      words[layer / 64] |= std::uint64_t{1} << layer % 64;
      layer /= 64;
    }
  }
  void erase(std::uint32_t layer) {
    for (auto& words : levels_) {
      std::uint64_t& word = words[layer / 64];
      word &= ~(std::uint64_t{1} << layer % 64);
      if (word != 0) return;
      layer /= 64;
    }
  }
  /// Calls use(layer) for the layers below `end` and above `behind`, which may be kNone, from the
  /// highest, until it returns false. Returns whether it never did.
  template <typename Use>
  bool each_between(std::uint32_t end, std::uint32_t behind, const Use& use) const {
    const std::uint32_t least = behind == kNone ? 0 : behind + 1;
    for (std::uint32_t top = highest_below(end); top != kNone && top >= least;
         top = highest_below(top / 64 * 64)) {
      std::uint64_t bits = levels_[0][top / 64] & (~std::uint64_t{0} >> (63 - top % 64));
      for (; bits != 0; bits ^= std::uint64_t{1} << highest(bits)) {
        const std::uint32_t layer = top / 64 * 64 + highest(bits);
        if (layer < least) return true;
        if (!use(layer)) return false;
      }
    }
    return true;
  }
  /// The highest layer below `end`, or kNone.
  std::uint32_t highest_below(std::uint32_t end) const {
    for (std::size_t level = 0; level < levels_.size(); ++level) {
      std::uint32_t at = end / 64;
      std::uint64_t bits = levels_[level][at] & ((std::uint64_t{1} << end % 64) - 1);
      if (bits == 0) {
        end = at;
        continue;
      }
      at = 64 * at + highest(bits);
      while (level > 0) at = 64 * at + highest(levels_[--level][at]);
      return at;
    }
    return kNone;
  }

 private:
  static std::uint32_t highest(std::uint64_t bits) {
    return static_cast<std::uint32_t>(std::bit_width(bits)) - 1;
  }

  std::vector<std::vector<std::uint64_t>> levels_;
};

}  // namespace prefilter
