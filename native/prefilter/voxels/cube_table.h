// SPDX-License-Identifier: GPL-3.0-or-later

// A hash table over the cubes of a grid.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace prefilter {

/// Maps the keys of cubes (cube_keys.h) to values. Adjacent cubes share blocks, for locality.
template <typename Value>
class CubeTable {
 public:
  CubeTable() : slots_(kMinSlots, Slot{kNone, 0}) {}

  bool is_empty() const { return values_.empty(); }
  std::size_t size() const { return values_.size(); }

  /// Null if there is no value.
  const Value* find(std::uint64_t key) const {
    const Slot& slot = slots_[slot_of(key & ~kWithin)];
    if (slot.key == kNone) return nullptr;
    const std::uint32_t number = blocks_[slot.block][index_of(key)];
    return number == 0 ? nullptr : &values_[number - 1];
  }

  /// The value of a cube, default-constructed if there is none.
  Value& operator[](std::uint64_t key) {
    std::size_t at = slot_of(key & ~kWithin);
    if (slots_[at].key == kNone) {
      if (2 * blocks_.size() >= slots_.size()) {
        grow();
        at = slot_of(key & ~kWithin);
      }
      slots_[at] = {key & ~kWithin, static_cast<std::uint32_t>(blocks_.size())};
      blocks_.emplace_back();
    }
    std::uint32_t& number = blocks_[slots_[at].block][index_of(key)];
    if (number == 0) {
      values_.emplace_back();
      number = static_cast<std::uint32_t>(values_.size());
    }
    return values_[number - 1];
  }

 private:
  // A block has four cubes per axis.
  static constexpr std::uint64_t kWithin =
      3U | (std::uint64_t{3} << 21U) | (std::uint64_t{3} << 42U);
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  static constexpr std::size_t kMinSlots = 64;

  struct Slot {
    std::uint64_t key;
    std::uint32_t block;
  };

  static std::size_t index_of(std::uint64_t key) {
    return static_cast<std::size_t>((key & 3U) | ((key >> 19U) & 12U) | ((key >> 38U) & 48U));
  }

  // Slot of a block, or the free slot that it would get.
  std::size_t slot_of(std::uint64_t key) const {
    std::uint64_t mixed = key * 0x9E3779B97F4A7C15U;
    mixed = (mixed ^ (mixed >> 29U)) * 0xBF58476D1CE4E5B9U;
    std::size_t at = static_cast<std::size_t>(mixed >> 32U) & (slots_.size() - 1);
    while (slots_[at].key != key && slots_[at].key != kNone) at = (at + 1) & (slots_.size() - 1);
    return at;
  }

  void grow() {
    std::vector<Slot> old(2 * slots_.size(), Slot{kNone, 0});
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.key != kNone) slots_[slot_of(slot.key)] = slot;
    }
  }

  std::vector<Slot> slots_;
  std::vector<std::array<std::uint32_t, 64>> blocks_;  // 1 + index of the value; 0: none
  std::vector<Value> values_;
};

}  // namespace prefilter
