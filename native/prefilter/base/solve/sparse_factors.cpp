// SPDX-License-Identifier: GPL-3.0-or-later

// Nested dissection: A. George, Nested dissection of a regular finite element mesh (1973), with
// cuts by coordinates. Up-looking factorization along the elimination tree: T. A. Davis, Algorithm
// 849: a concise sparse Cholesky factorization package (2005).
#include "prefilter/base/solve/sparse_factors.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace prefilter {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
// Parts with at most this many rows are not dissected.
constexpr std::size_t kMaxLeafRows = 24;
// Multiplications between two progress reports.
constexpr std::size_t kProductsPerReport = 1U << 21U;
// Relative to a row's diagonal entry: smaller pivots are rounding errors.
constexpr double kMinPivot = 1e-13;

// Concatenated lists of numbers.
struct Lists {
  std::vector<std::size_t> begins;
  std::vector<std::uint32_t> items;

  std::span<const std::uint32_t> of(std::size_t i) const {
    return std::span(items).subspan(begins[i], begins[i + 1] - begins[i]);
  }
};

Lists neighbors_of(std::size_t count, std::span<const SparseEntry> lower) {
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

// Sorts rows into elimination order: both sides of a cut, recursively, before the rows between
// them.
class Dissection {
 public:
  Dissection(const Lists& neighbors, std::span<const Vector3> places)
      : neighbors_(neighbors), places_(places), stamps_(places.size(), 0) {}

  void sort(std::span<std::uint32_t> rows) {
    if (rows.size() <= kMaxLeafRows) return;
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
    const auto others = neighbors_.of(row);
    return std::any_of(others.begin(), others.end(),
                       [&](std::uint32_t other) { return stamps_[other] == stamp_; });
  }

  const Lists& neighbors_;
  std::span<const Vector3> places_;
  std::vector<std::uint32_t> stamps_;
  std::uint32_t stamp_ = 0;
};

bool comes_first(const SparseEntry& a, const SparseEntry& b) {
  return a.row != b.row ? a.row < b.row : a.column < b.column;
}

// Sums entries at the same position.
void sum_duplicates(std::vector<SparseEntry>* entries) {
  // Stable, so that the order of summation does not depend on the standard library.
  std::stable_sort(entries->begin(), entries->end(), comes_first);
  std::size_t unique_count = 0;
  for (const SparseEntry& entry : *entries) {
    if (unique_count > 0 && !comes_first((*entries)[unique_count - 1], entry)) {
      (*entries)[unique_count - 1].value += entry.value;
    } else {
      (*entries)[unique_count++] = entry;
    }
  }
  entries->resize(unique_count);
}

// Renumbers and sorts the entries by elimination step.
void sort_by_steps(std::span<const std::uint32_t> order, std::vector<SparseEntry>* entries) {
  std::vector<std::uint32_t> steps(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) steps[order[i]] = static_cast<std::uint32_t>(i);
  for (SparseEntry& entry : *entries) {
    const std::uint32_t a = steps[entry.row];
    const std::uint32_t b = steps[entry.column];
    entry = {std::max(a, b), std::min(a, b), entry.value};
  }
  std::sort(entries->begin(), entries->end(), comes_first);
}

// Start index of each row's entries, followed by the end.
std::vector<std::size_t> row_begins_of(std::size_t count, std::span<const SparseEntry> entries) {
  std::vector<std::size_t> begins(count + 1, 0);
  for (const SparseEntry& entry : entries) ++begins[entry.row + 1];
  for (std::size_t i = 0; i < count; ++i) begins[i + 1] += begins[i];
  return begins;
}

// Calls visit(column) for the columns from one up the elimination tree, until one that was visited
// for this row.
template <typename Visit>
void for_path(std::uint32_t row, std::uint32_t column, std::span<const std::uint32_t> parents,
              std::span<std::uint32_t> seen, const Visit& visit) {
  for (std::uint32_t at = column; seen[at] != row; at = parents[at]) {
    visit(at);
    seen[at] = row;
  }
}

// The elimination tree, and the lengths of the factor's columns.
struct EliminationTree {
  std::vector<std::uint32_t> parents;
  std::vector<std::size_t> lengths;
};

EliminationTree elimination_tree(std::span<const std::size_t> row_begins,
                                 std::span<const SparseEntry> entries) {
  const std::size_t count = row_begins.size() - 1;
  EliminationTree tree{std::vector<std::uint32_t>(count, kNone), std::vector<std::size_t>(count)};
  std::vector<std::uint32_t> seen(count, kNone);
  for (std::uint32_t row = 0; row < count; ++row) {
    seen[row] = row;
    for (std::size_t e = row_begins[row]; e < row_begins[row + 1]; ++e) {
      for_path(row, entries[e].column, tree.parents, seen, [&](std::uint32_t at) {
        if (tree.parents[at] == kNone) tree.parents[at] = row;
        ++tree.lengths[at];
      });
    }
  }
  return tree;
}

}  // namespace

SparseFactors::SparseFactors(std::vector<SparseEntry> lower, std::span<const Vector3> places,
                             const Run& run)
    : order_(places.size()), diagonal_(places.size()), begins_(places.size() + 1, 0) {
  const std::size_t count = places.size();
  run.report(0.0);
  sum_duplicates(&lower);
  run.report(0.1);
  for (std::size_t i = 0; i < count; ++i) order_[i] = static_cast<std::uint32_t>(i);
  Dissection(neighbors_of(count, lower), places).sort(order_);
  sort_by_steps(order_, &lower);
  run.report(0.2);

  const std::vector<std::size_t> row_begins = row_begins_of(count, lower);
  const EliminationTree tree = elimination_tree(row_begins, lower);
  for (std::size_t i = 0; i < count; ++i) begins_[i + 1] = begins_[i] + tree.lengths[i];
  rows_.resize(begins_.back());
  values_.resize(begins_.back());
  is_definite_ = factorize(lower, row_begins, tree.parents, run.part(0.2, 1.0));
}

bool SparseFactors::factorize(std::span<const SparseEntry> entries,
                              std::span<const std::size_t> row_begins,
                              std::span<const std::uint32_t> parents, const Run& run) {
  const std::size_t count = order_.size();
  double products = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto length = static_cast<double>(begins_[i + 1] - begins_[i]);
    products += length * length / 2.0;
  }
  std::vector<double> row_values(count, 0.0);
  std::vector<std::uint32_t> pattern(count);
  std::vector<std::uint32_t> seen(count, kNone);
  std::vector<std::size_t> ends(begins_.begin(), begins_.end() - 1);
  std::size_t since_report = 0;
  double finished_products = 0.0;
  for (std::uint32_t row = 0; row < count; ++row) {
    // The nonzero columns of the row, each after its descendants in the tree.
    std::size_t top = count;
    seen[row] = row;
    double own = 0.0;
    for (std::size_t e = row_begins[row]; e < row_begins[row + 1]; ++e) {
      if (entries[e].column == row) {
        own = entries[e].value;
        continue;
      }
      row_values[entries[e].column] = entries[e].value;
      std::size_t length = 0;
      for_path(row, entries[e].column, parents, seen,
               [&](std::uint32_t at) { pattern[length++] = at; });
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
    if (!(own > kMinPivot * scale)) return false;
    diagonal_[row] = own;
    if (since_report > kProductsPerReport) {
      finished_products += static_cast<double>(std::exchange(since_report, 0));
      run.report(finished_products / std::max(products, 1.0));
    }
  }
  run.report(1.0);
  return true;
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
