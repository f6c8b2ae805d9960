// SPDX-License-Identifier: GPL-3.0-or-later

// Nested dissection: A. George, Nested dissection of a regular finite element mesh (1973), with
// cuts between the coordinates. Factors row by row along the elimination tree: T. A. Davis,
// Algorithm 849: a concise sparse Cholesky factorization package (2005).
#include "prefilter/solve/sparse_factors.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace prefilter {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
// Parts of so few rows are not cut any further.
constexpr std::size_t kUncut = 24;
// Steps with so many products between two reports.
constexpr std::size_t kProductsPerReport = 1U << 21U;

// Lists of numbers, one after the other.
struct Lists {
  std::vector<std::size_t> begins;
  std::vector<std::uint32_t> items;

  std::span<const std::uint32_t> of(std::size_t i) const {
    return std::span(items).subspan(begins[i], begins[i + 1] - begins[i]);
  }
};

Lists neighbours_of(std::size_t count, std::span<const SparseEntry> lower) {
  Lists lists;
  lists.begins.assign(count + 1, 0);
  for (const SparseEntry& entry : lower) {
    if (entry.row == entry.column) continue;
    ++lists.begins[entry.row + 1];
    ++lists.begins[entry.column + 1];
  }
  for (std::size_t i = 0; i < count; ++i) lists.begins[i + 1] += lists.begins[i];
  lists.items.resize(lists.begins.back());
  std::vector<std::size_t> ends(lists.begins.begin(), lists.begins.end() - 1);
  for (const SparseEntry& entry : lower) {
    if (entry.row == entry.column) continue;
    lists.items[ends[entry.row]++] = entry.column;
    lists.items[ends[entry.column]++] = entry.row;
  }
  return lists;
}

// Puts rows into the order in which they are eliminated: both sides of a cut, each cut in turn,
// before the rows between them.
class Dissection {
 public:
  Dissection(const Lists& neighbours, std::span<const Vector3> places)
      : neighbours_(neighbours), places_(places), stamps_(places.size(), 0) {}

  void sort(std::span<std::uint32_t> rows) {
    if (rows.size() <= kUncut) return;
    Box box = kEmptyBox;
    for (const std::uint32_t row : rows) box.include(places_[row]);
    int axis = 0;
    for (int a = 1; a < 3; ++a) {
      if (box.size(a) > box.size(axis)) axis = a;
    }
    const std::size_t half = rows.size() / 2;
    std::nth_element(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(half), rows.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                       const double x = places_[a][static_cast<std::size_t>(axis)];
                       const double y = places_[b][static_cast<std::size_t>(axis)];
                       return x != y ? x < y : a < b;
                     });
    ++stamp_;
    for (const std::uint32_t row : rows.subspan(half)) stamps_[row] = stamp_;
    const auto cut =
        std::stable_partition(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(half),
                              [&](std::uint32_t row) { return !meets_stamp(row); });
    const auto low = static_cast<std::size_t>(cut - rows.begin());
    std::rotate(cut, rows.begin() + static_cast<std::ptrdiff_t>(half), rows.end());
    const std::size_t high = rows.size() - half;
    sort(rows.subspan(0, low));
    sort(rows.subspan(low, high));
  }

 private:
  bool meets_stamp(std::uint32_t row) const {
    const auto others = neighbours_.of(row);
    return std::any_of(others.begin(), others.end(),
                       [&](std::uint32_t other) { return stamps_[other] == stamp_; });
  }

  const Lists& neighbours_;
  std::span<const Vector3> places_;
  std::vector<std::uint32_t> stamps_;
  std::uint32_t stamp_ = 0;
};

}  // namespace

SparseFactors::SparseFactors(std::vector<SparseEntry> lower, std::span<const Vector3> places,
                             const Progress& progress)
    : order_(places.size()), diagonal_(places.size()), begins_(places.size() + 1, 0) {
  const std::size_t count = places.size();
  progress.report(0.0);
  const auto comes_first = [](const SparseEntry& a, const SparseEntry& b) {
    return a.row != b.row ? a.row < b.row : a.column < b.column;
  };
  // Stable, so that the sums of what is at one place do not depend on the library's sort.
  std::stable_sort(lower.begin(), lower.end(), comes_first);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < lower.size(); ++i) {
    if (kept > 0 && !comes_first(lower[kept - 1], lower[i])) {
      lower[kept - 1].value += lower[i].value;
    } else {
      lower[kept++] = lower[i];
    }
  }
  lower.resize(kept);
  progress.report(0.1);

  for (std::size_t i = 0; i < count; ++i) order_[i] = static_cast<std::uint32_t>(i);
  Dissection(neighbours_of(count, lower), places).sort(order_);
  std::vector<std::uint32_t> steps(count);
  for (std::size_t i = 0; i < count; ++i) steps[order_[i]] = static_cast<std::uint32_t>(i);
  for (SparseEntry& entry : lower) {
    const std::uint32_t a = steps[entry.row];
    const std::uint32_t b = steps[entry.column];
    entry = {std::max(a, b), std::min(a, b), entry.value};
  }
  std::sort(lower.begin(), lower.end(), comes_first);
  progress.report(0.2);

  std::vector<std::size_t> row_begins(count + 1, 0);
  for (const SparseEntry& entry : lower) ++row_begins[entry.row + 1];
  for (std::size_t i = 0; i < count; ++i) row_begins[i + 1] += row_begins[i];

  // The elimination tree, and how long the columns become.
  std::vector<std::uint32_t> parents(count, kNone);
  std::vector<std::uint32_t> seen(count, kNone);
  std::vector<std::size_t> lengths(count, 0);
  for (std::uint32_t row = 0; row < count; ++row) {
    seen[row] = row;
    for (std::size_t e = row_begins[row]; e < row_begins[row + 1]; ++e) {
      for (std::uint32_t at = lower[e].column; seen[at] != row; at = parents[at]) {
        if (parents[at] == kNone) parents[at] = row;
        ++lengths[at];
        seen[at] = row;
      }
    }
  }
  double products = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    begins_[i + 1] = begins_[i] + lengths[i];
    products += static_cast<double>(lengths[i]) * static_cast<double>(lengths[i]) / 2.0;
  }
  rows_.resize(begins_.back());
  values_.resize(begins_.back());

  std::vector<double> row_values(count, 0.0);
  std::vector<std::uint32_t> pattern(count);
  std::vector<std::size_t> ends(begins_.begin(), begins_.end() - 1);
  std::fill(seen.begin(), seen.end(), kNone);
  std::size_t since_report = 0;
  double done = 0.0;
  for (std::uint32_t row = 0; row < count; ++row) {
    // The columns in which the row is not 0, each after those below it in the tree.
    std::size_t top = count;
    seen[row] = row;
    double own = 0.0;
    for (std::size_t e = row_begins[row]; e < row_begins[row + 1]; ++e) {
      if (lower[e].column == row) {
        own = lower[e].value;
        continue;
      }
      row_values[lower[e].column] = lower[e].value;
      std::size_t length = 0;
      for (std::uint32_t at = lower[e].column; seen[at] != row; at = parents[at]) {
        pattern[length++] = at;
        seen[at] = row;
      }
      while (length > 0) pattern[--top] = pattern[--length];
    }
    const double scale = own;
    for (; top < count; ++top) {
      const std::uint32_t column = pattern[top];
      const double value = std::exchange(row_values[column], 0.0);
      const std::size_t end = ends[column];
      for (std::size_t i = begins_[column]; i < end; ++i)
        row_values[rows_[i]] -= values_[i] * value;
      since_report += end - begins_[column];
      const double share = value / diagonal_[column];
      own -= share * value;
      rows_[end] = row;
      values_[end] = share;
      ++ends[column];
    }
    if (!(own > 1e-13 * scale)) {
      is_definite_ = false;
      return;
    }
    diagonal_[row] = own;
    if (since_report > kProductsPerReport) {
      done += static_cast<double>(std::exchange(since_report, 0));
      progress.report(0.2 + 0.8 * done / std::max(products, 1.0));
    }
  }
  progress.report(1.0);
}

void SparseFactors::solve(std::span<Vector3> values) const {
  const std::size_t count = order_.size();
  std::vector<Vector3> x(count);
  for (std::size_t i = 0; i < count; ++i) x[i] = values[order_[i]];
  for (std::size_t column = 0; column < count; ++column) {
    for (std::size_t i = begins_[column]; i < begins_[column + 1]; ++i) {
      for (std::size_t a = 0; a < 3; ++a) x[rows_[i]][a] -= values_[i] * x[column][a];
    }
  }
  for (std::size_t column = count; column-- > 0;) {
    for (double& v : x[column]) v /= diagonal_[column];
    for (std::size_t i = begins_[column]; i < begins_[column + 1]; ++i) {
      for (std::size_t a = 0; a < 3; ++a) x[column][a] -= values_[i] * x[rows_[i]][a];
    }
  }
  for (std::size_t i = 0; i < count; ++i) values[order_[i]] = x[i];
}

}  // namespace prefilter
