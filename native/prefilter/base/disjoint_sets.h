// SPDX-License-Identifier: GPL-3.0-or-later

// Union-find (Galler and Fischer 1964) with path halving (van Leeuwen and van der Weide 1977).
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace prefilter {

/// The root of a set is its lowest member, regardless of the order of joins.
template <typename Index>
class DisjointSets {
 public:
  /// Sets of one member each.
  explicit DisjointSets(std::size_t count = 0) : above_(count) {
    std::iota(above_.begin(), above_.end(), Index{0});
  }

  std::size_t size() const { return above_.size(); }

  /// Adds a set with one member, and returns it.
  Index add() {
    above_.push_back(static_cast<Index>(above_.size()));
    return above_.back();
  }

  Index root(Index i) const {
    while (above_[at(i)] != i) i = above_[at(i)];
    return i;
  }

  void join(Index i, Index j) {
    const Index a = halve(i);
    const Index b = halve(j);
    above_[at(std::max(a, b))] = std::min(a, b);
  }

  /// `join`, callable by several threads concurrently.
  void join_from_threads(Index i, Index j) {
    while (true) {
      const Index a = halve_from_threads(i);
      const Index b = halve_from_threads(j);
      if (a == b) return;
      Index high = std::max(a, b);
      if (link(high).compare_exchange_strong(high, std::min(a, b), std::memory_order_relaxed)) {
        return;
      }
    }
  }

  /// The root of each member.
  std::vector<Index> roots() && {
    // Parents are lower, so they already refer to their roots.
    for (Index& above : above_) above = above_[at(above)];
    return std::move(above_);
  }

  /// The number of each member's set, in order of roots; sets `*count` to the number of sets.
  std::vector<Index> numbers(Index* count) const {
    std::vector<Index> result(above_.size());
    *count = 0;
    for (std::size_t i = 0; i < above_.size(); ++i) {
      result[i] = at(above_[i]) == i ? (*count)++ : result[at(above_[i])];
    }
    return result;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  std::atomic_ref<Index> link(Index i) { return std::atomic_ref<Index>(above_[at(i)]); }

  Index halve(Index i) {
    while (above_[at(i)] != i) i = above_[at(i)] = above_[at(above_[at(i)])];
    return i;
  }
  Index halve_from_threads(Index i) {
    while (true) {
      const Index above = link(i).load(std::memory_order_relaxed);
      if (above == i) return i;
      // Roots are only joined to lower ones, so ancestors remain ancestors.
      const Index next = link(above).load(std::memory_order_relaxed);
      if (next != above) link(i).store(next, std::memory_order_relaxed);
      i = next;
    }
  }

  std::vector<Index> above_;
};

}  // namespace prefilter
