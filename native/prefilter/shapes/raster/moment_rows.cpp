// SPDX-License-Identifier: GPL-3.0-or-later

// Differences between pixels are added only where arcs change them; the cells between arcs form
// runs of constant coverage.
#include "prefilter/shapes/raster/moment_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace prefilter {
namespace {

constexpr double kMomentRowsUnit = 1.0 / (1 << kMomentBits);
// Bits of a run's weights, so that weights times moments are coverage.
constexpr int kWeightBits = kCoverageBits - kMomentBits;

}  // namespace

template <int N>
MomentRows<N>::MomentRows(const CellFilter& filter, int width) : filter_(filter), width_(width) {
  const int taps = filter.taps;
  using ByBasis = std::array<double, 2 * kPairs>;
  // Expresses powers of y in P_b: y^b is P_b plus its mean times P_0.
  const auto by_basis = [&](const auto& coefficient) {
    ByBasis out{};
    for (int b = 0; b < kCount; ++b) {
      out[b] += coefficient(b);
      if (b > 0) out[0] += coefficient(b) * mean_power(b);
    }
    return out;
  };
  const auto as_pairs = [](const ByBasis& values) {
    Powers powers;
    std::memcpy(powers.v, values.data(), sizeof powers.v);
    return powers;
  };
  std::vector<ByBasis> run_weights;
  if (filter.is_separable) {
    integrals_before_.push_back(0.0);
    for (int tap = 0; tap < taps; ++tap) {
      const double* along = filter.along.data() + tap * kCount;
      run_weights.push_back(by_basis([&](int b) { return along[b]; }));
      double integral = 0.0;
      for (int a = 0; a < kCount; ++a) integral += along[a] * mean_power(a);
      integrals_before_.push_back(integrals_before_.back() + integral);
      for (int b = 0; b < kCount; ++b) along_y_[b].v[tap / 2][tap % 2] = run_weights.back()[b];
    }
    integrals_before_.back() = 1.0;
  } else {
    for (int oy = 0; oy < taps; ++oy) {
      ByBasis before{};
      table_before_.push_back({});
      for (int ox = 0; ox < taps; ++ox) {
        const double* piece = filter.table.data() + (oy * taps + ox) * kCount * kCount;
        for (int a = 0; a < kCount; ++a) {
          const ByBasis powers = by_basis([&](int b) { return piece[b * kCount + a]; });
          table_.push_back(as_pairs(powers));
          for (int b = 0; b < kCount; ++b) before[b] += powers[b] * mean_power(a);
        }
        table_before_.push_back(as_pairs(before));
      }
      run_weights.push_back(before);
    }
  }
  constexpr double kScale = std::int64_t{1} << kWeightBits;
  std::int64_t sum = 0;
  for (const ByBasis& weights : run_weights) {
    Across rounded{};
    for (int b = 0; b < kCount; ++b) rounded[b] = std::llrint(weights[b] * kScale);
    sum += rounded[0];
    run_weights_.push_back(rounded);
  }
  // Makes the weights of a full row add up to exactly 1.
  run_weights_[taps / 2][0] += (std::int64_t{1} << kWeightBits) - sum;
}

template <int N>
std::int64_t MomentRows<N>::run_value(int tap, const Across& across) const {
  std::int64_t value = 0;
  for (int b = 0; b < kCount; ++b) value += run_weights_[tap][b] * across[b];
  return value;
}

template <int N>
int MomentRows<N>::taps_before(int pixel, int column) const {
  return std::clamp(column - filter_.first_cell(pixel), 0, filter_.taps);
}

template <int N>
void MomentRows<N>::add_coverage(const MomentCells<N>& cells, int first_row, int end_row,
                                 CoverageRows* rows) {
  first_row_ = first_row;
  end_row_ = end_row;
  for (int row = cells.first_used_row(); row < cells.end_used_row(); ++row) {
    cells.columns_of(row, &columns_);
    Across across = cells.left_of(row);
    start_row(row, across, rows);
    // Cells between two columns whose pixels do not overlap form a run.
    for (std::size_t begin = 0; begin < columns_.size();) {
      std::size_t end = begin + 1;
      while (end < columns_.size() && columns_[end] < columns_[end - 1] + filter_.taps) ++end;
      add_span(cells, row, std::span(columns_).subspan(begin, end - begin), &across, rows);
      begin = end;
    }
  }
}

// The arcs left of all columns contribute a run from the first pixel on.
template <int N>
void MomentRows<N>::start_row(int row, const Across& across, CoverageRows* rows) {
  const int begin_y = std::max(first_row_, filter_.first_pixel_over(row));
  const int end_y = std::min(end_row_, filter_.last_pixel_over(row) + 1);
  for (int y = begin_y; y < end_y; ++y) {
    const std::int64_t value = run_value(row - filter_.first_cell(y), across);
    if (value != 0) rows->add_step(y - first_row_, 0, value);
  }
}

// Adds the cells [from, to), whose moments are equal.
template <int N>
void MomentRows<N>::add_equal_cells(int from, int to, const Across& across) {
  bool is_empty = true;
  std::array<double, 2 * kPairs> units{};
  for (int b = 0; b < kCount; ++b) {
    units[b] = static_cast<double>(across[b]) * kMomentRowsUnit;
    is_empty = is_empty && across[b] == 0;
  }
  if (is_empty) return;
  Powers moments;
  std::memcpy(moments.v, units.data(), sizeof moments.v);
  const int taps = filter_.taps;
  const int begin = std::max(first_pixel_, filter_.first_pixel_over(from));
  const int end = std::min(end_pixel_, filter_.last_pixel_over(to - 1) + 1);
  for (int pixel = begin; pixel < end; ++pixel) {
    const int low = taps_before(pixel, from);
    const int high = taps_before(pixel, to);
    if (filter_.is_separable) {
      const double share = integrals_before_[high] - integrals_before_[low];
      Powers& sums = sums_[pixel - first_pixel_];
      for (int q = 0; q < kPairs; ++q) sums.v[q] += share * moments.v[q];
      continue;
    }
    ByTap& values = values_[pixel - first_pixel_];
    for (int oy = 0; oy < taps; ++oy) {
      const Powers* before = table_before_.data() + oy * (taps + 1);
      Pair products{};
      for (int q = 0; q < kPairs; ++q) {
        products += moments.v[q] * (before[high].v[q] - before[low].v[q]);
      }
      values.v[oy / 2][oy % 2] += products[0] + products[1];
    }
  }
}

template <int N>
void MomentRows<N>::add_cell(int column, const ArcMoments<N>& cell, const Across& across) {
  using Integers = Vector<std::int32_t, 2>;
  const auto load = [&](int place) {
    Integers integers;
    std::memcpy(&integers, cell.sums.data() + place, sizeof integers);
    return integers;
  };
  Pair moments[kCount][kPairs];
  for (int q = 0; q < kPairs; ++q) {
    const Pair own = convert<Pair>(load(ArcMoments<N>::kAcross + 2 * q)) * kMomentRowsUnit;
    Pair before{};
    for (int b = 2 * q; b < std::min(2 * q + 2, kCount); ++b) {
      before[b % 2] = static_cast<double>(across[b]) * kMomentRowsUnit;
    }
    for (int a = 0; a < kCount; ++a) {
      const Pair inside = convert<Pair>(load(a * kCount + 2 * q)) * kMomentRowsUnit;
      moments[a][q] = own * at_high_end(a) - inside + before * mean_power(a);
    }
  }
  const int taps = filter_.taps;
  const int begin = std::max(first_pixel_, filter_.first_pixel_over(column));
  const int end = std::min(end_pixel_, filter_.last_pixel_over(column) + 1);
  for (int pixel = begin; pixel < end; ++pixel) {
    const int ox = column - filter_.first_cell(pixel);
    if (filter_.is_separable) {
      const double* along = filter_.along.data() + ox * kCount;
      Powers& sums = sums_[pixel - first_pixel_];
      for (int q = 0; q < kPairs; ++q) {
        Pair sum = moments[0][q] * along[0];
        for (int a = 1; a < kCount; ++a) sum += moments[a][q] * along[a];
        sums.v[q] += sum;
      }
      continue;
    }
    ByTap& values = values_[pixel - first_pixel_];
    for (int oy = 0; oy < taps; ++oy) {
      const Powers* powers = table_.data() + (oy * taps + ox) * kCount;
      Pair products{};
      for (int a = 0; a < kCount; ++a) {
        for (int q = 0; q < kPairs; ++q) products += powers[a].v[q] * moments[a][q];
      }
      values.v[oy / 2][oy % 2] += products[0] + products[1];
    }
  }
}

template <int N>
void MomentRows<N>::add_span(const MomentCells<N>& cells, int row, std::span<const int> columns,
                             Across* across, CoverageRows* rows) {
  // The pixels whose filter covers a cell of the span.
  first_pixel_ = std::max(0, filter_.first_pixel_over(columns.front()));
  end_pixel_ = std::min(width_, filter_.last_pixel_over(columns.back()) + 1);
  const int pixels = std::max(0, end_pixel_ - first_pixel_);
  const Across across_before = *across;
  if (filter_.is_separable) sums_.assign(pixels, {});
  values_.assign(pixels, {});

  constexpr int kFarColumn = 1 << 28;
  add_equal_cells(-kFarColumn, columns.front(), *across);
  int next = columns.front();
  for (const int column : columns) {
    if (column > next) add_equal_cells(next, column, *across);
    const ArcMoments<N>& cell = cells.at(column, row);
    add_cell(column, cell, *across);
    for (int b = 0; b < kCount; ++b) (*across)[b] += cell.across(b);
    next = column + 1;
  }
  add_equal_cells(next, kFarColumn, *across);

  constexpr double kScale = std::int64_t{1} << kCoverageBits;
  const int tap_pairs = (filter_.taps + 1) / 2;
  for (int i = 0; i < pixels; ++i) {
    ByTap& values = values_[i];
    if (filter_.is_separable) {
      double sums[2 * kPairs];
      std::memcpy(sums, sums_[i].v, sizeof sums);
      for (int pair = 0; pair < tap_pairs; ++pair) {
        Pair sum = sums[0] * along_y_[0].v[pair];
        for (int b = 1; b < kCount; ++b) sum += sums[b] * along_y_[b].v[pair];
        values.v[pair] = sum;
      }
    }
    for (int pair = 0; pair < tap_pairs; ++pair) values.v[pair] *= kScale;
  }
  // The pixel rows whose filter covers this row of cells.
  const int begin_y = std::max(first_row_, filter_.first_pixel_over(row));
  const int end_y = std::min(end_row_, filter_.last_pixel_over(row) + 1);
  for (int y = begin_y; y < end_y; ++y) {
    const int tap = row - filter_.first_cell(y);
    std::int64_t* steps = rows->change(y - first_row_, first_pixel_, end_pixel_ + 1);
    const double* values = reinterpret_cast<const double*>(values_.data()) + tap;
    std::int64_t last = run_value(tap, across_before);
    for (int i = 0; i < pixels; ++i) {
      const std::int64_t here = std::llrint(values[kMaxTaps * i]);
      steps[i] += here - last;
      last = here;
    }
    steps[pixels] += run_value(tap, *across) - last;
  }
}

template class MomentRows<0>;
template class MomentRows<1>;
template class MomentRows<2>;
template class MomentRows<3>;
template class MomentRows<7>;

}  // namespace prefilter
