// SPDX-License-Identifier: GPL-3.0-or-later

// Parallel, cancellable sorting.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "prefilter/base/parallel.h"

namespace prefilter {

namespace sort_detail {

constexpr std::size_t kPiece = 1U << 15;  // elements; a few milliseconds of work

/// Number of elements from the first range among the first `count` elements of two merged sorted
/// ranges. Equal elements of the first range come first.
template <typename T, typename Less>
std::size_t share_of_first(const T* a, std::size_t a_size, const T* b, std::size_t b_size,
                           std::size_t count, const Less& less) {
  std::size_t low = count > b_size ? count - b_size : 0;
  std::size_t high = std::min(count, a_size);
  while (low < high) {
    const std::size_t i = low + (high - low) / 2;
    if (less(b[count - i - 1], a[i])) {
      high = i;
    } else {
      low = i + 1;
    }
  }
  return low;
}

/// Writes elements [begin, end) of the merged ranges a and b.
template <typename T, typename Less>
void merge_piece(const T* a, std::size_t a_size, const T* b, std::size_t b_size, std::size_t begin,
                 std::size_t end, const Less& less, T* merged) {
  const std::size_t i = share_of_first(a, a_size, b, b_size, begin, less);
  const std::size_t last = share_of_first(a, a_size, b, b_size, end, less);
  std::merge(a + i, a + last, b + (begin - i), b + (end - last), merged + begin, less);
}

}  // namespace sort_detail

/// Sorts by a strict total order, under which distinct elements are never equivalent. Needs the
/// same amount of memory again. Throws Error(kCancelled), and then leaves the elements in some
/// order.
template <typename T, typename Less = std::less<T>>
void sort_in_parallel(std::vector<T>* values, const Run& run, const Less& less = Less()) {
  using sort_detail::kPiece;
  const std::size_t count = values->size();
  const auto pieces = static_cast<std::int64_t>((count + kPiece - 1) / kPiece);
  int passes = 0;
  while ((kPiece << passes) < count) ++passes;
  // A pass takes about a sixth of the time of sorting the pieces.
  const double pass_share = 1.0 / (6.0 + passes);
  const double sorted = 1.0 - passes * pass_share;
  parallel_for(pieces, run.part(0.0, sorted), [&](std::int64_t piece) {
    const std::size_t begin = static_cast<std::size_t>(piece) * kPiece;
    std::sort(values->data() + begin, values->data() + std::min(count, begin + kPiece), less);
  });
  if (passes == 0) return;
  std::vector<T> other(count);
  for (int pass = 0; pass < passes; ++pass) {
    const std::size_t width = kPiece << pass;
    const Run part = run.part(sorted + pass * pass_share, sorted + (pass + 1) * pass_share);
    parallel_for(pieces, part, [&](std::int64_t piece) {
      const std::size_t at = static_cast<std::size_t>(piece) * kPiece;
      const std::size_t begin = at / (2 * width) * (2 * width);
      const std::size_t middle = std::min(count, begin + width);
      const std::size_t end = std::min(count, begin + 2 * width);
      sort_detail::merge_piece(values->data() + begin, middle - begin, values->data() + middle,
                               end - middle, at - begin, std::min(end, at + kPiece) - begin, less,
                               other.data() + begin);
    });
    values->swap(other);
  }
}

}  // namespace prefilter
