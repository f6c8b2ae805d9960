// SPDX-License-Identifier: GPL-3.0-or-later

// Assigns consecutive indices to 64-bit keys.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace prefilter {

class KeyIndex {
 public:
  KeyIndex() : slots_(64, kEmpty) {}

  void clear() {
    keys_.clear();
    std::fill(slots_.begin(), slots_.end(), kEmpty);
  }
  std::span<const std::uint64_t> keys() const { return keys_; }
  /// Index of a key; a new key gets the next index.
  std::uint32_t index_of(std::uint64_t key) {
    if (2 * keys_.size() >= slots_.size()) grow();
    const std::size_t slot = slot_of(key);
    if (slots_[slot] == kEmpty) {
      slots_[slot] = static_cast<std::uint32_t>(keys_.size());
      keys_.push_back(key);
    }
    return slots_[slot];
  }

 private:
  static constexpr std::uint32_t kEmpty = UINT32_MAX;

  std::size_t slot_of(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = ((key ^ key >> 32) * 0x9e3779b97f4a7c15u >> 40) & mask;
    while (slots_[slot] != kEmpty && keys_[slots_[slot]] != key) slot = (slot + 1) & mask;
    return slot;
  }
  void grow() {
    slots_.assign(2 * slots_.size(), kEmpty);
    for (std::uint32_t i = 0; i < keys_.size(); ++i) slots_[slot_of(keys_[i])] = i;
  }

  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> slots_;
};

}  // namespace prefilter
