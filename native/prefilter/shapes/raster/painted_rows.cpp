// SPDX-License-Identifier: GPL-3.0-or-later

// Section 2.2.1 with a polynomial color: the moments of the color are those of the region, shifted
// by the color's exponents.
#include "prefilter/shapes/raster/painted_rows.h"

#include <span>

namespace prefilter {
namespace {

constexpr double kPaintedRowsUnit = 1.0 / (1 << kMomentBits);

}  // namespace

template <int N>
PaintedRows<N>::PaintedRows(const CellFilter& filter, int width)
    : filter_(filter), is_box_(filter.taps == 1 && filter.degree == 0), pixels_(filter, width) {}

template <int N>
void PaintedRows<N>::add_cell(int column, int row, const Moments& moments,
                              const LocalColor& color) {
  if (is_box_) {
    pixels_.add_row(column, column + 1, row, [&](int, int, double* out) {
      color.add_integral(column, row, {moments[0][0], moments[1][0], moments[0][1]}, out);
    });
    return;
  }
  std::array<LinearPowers, kMaxChannels> powers;
  color.powers(column, row, &powers);
  const int count = filter_.degree + 1;
  const int channels = color.channels();
  for (int c = 0; c < channels; ++c) {
    // Moments of the color: products of the powers of the color and of the filter.
    std::array<double, (N + 1) * (N + 1)> colored{};
    for (std::size_t k = 0; k < powers[c].size(); ++k) {
      const auto [m, n] = kLinearExponents[k];
      for (int a = 0; a < count; ++a) {
        for (int b = 0; b < count; ++b) {
          colored[a * count + b] += powers[c][k] * moments[a + m][b + n];
        }
      }
    }
    pixels_.add(column, row, c, colored);
  }
}

template <int N>
void PaintedRows<N>::add_full_cells(int begin, int end, int row, double share,
                                    const LocalColor& color) {
  if (is_box_) {
    pixels_.add_row(begin, end, row, [&](int first, int last, double* out) {
      color.add_means(first, last, row, share, out);
    });
    return;
  }
  std::array<LinearPowers, kMaxChannels> powers;
  const auto channels = static_cast<std::size_t>(color.channels());
  for (int column = begin; column < end; ++column) {
    color.powers(column, row, &powers);
    pixels_.add_full(column, row, share, std::span(powers).first(channels));
  }
}

template <int N>
void PaintedRows<N>::add_values(const MomentCells<N>& cells, const LocalColor& color, int first_row,
                                int end_row, BandValues* values) {
  pixels_.begin(first_row, end_row, values);
  const int end_column = cells.window().end_column;
  for (int row = cells.first_used_row(); row < cells.end_used_row(); ++row) {
    cells.columns_of(row, &columns_);
    std::array<std::int64_t, N + 1> across = cells.left_of(row);
    // From P_b to powers of y.
    const auto in_powers = [](std::array<double, N + 1> by_basis) {
      for (int b = 1; b <= N; ++b) by_basis[b] += mean_power(b) * by_basis[0];
      return by_basis;
    };
    const auto add_equal_cells = [&](int begin, int end) {
      bool is_full = true;
      for (int b = 1; b <= N; ++b) is_full = is_full && across[b] == 0;
      if (is_full) {
        const double share = static_cast<double>(across[0]) * kPaintedRowsUnit;
        if (across[0] != 0) add_full_cells(begin, end, row, share, color);
        return;
      }
      std::array<double, N + 1> line;
      for (int b = 0; b <= N; ++b) line[b] = static_cast<double>(across[b]) * kPaintedRowsUnit;
      line = in_powers(line);
      Moments moments;
      for (int a = 0; a <= N; ++a) {
        for (int b = 0; b <= N; ++b) moments[a][b] = mean_power(a) * line[b];
      }
      for (int column = begin; column < end; ++column) add_cell(column, row, moments, color);
    };
    add_equal_cells(cells.window().first_column, columns_.empty() ? end_column : columns_.front());
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const int column = columns_[i];
      const ArcMoments<N>& cell = cells.at(column, row);
      Moments moments;
      for (int a = 0; a <= N; ++a) {
        std::array<double, N + 1> line;
        for (int b = 0; b <= N; ++b) {
          line[b] = kPaintedRowsUnit * (at_high_end(a) * cell.across(b) - cell.inside(a, b) +
                                        mean_power(a) * static_cast<double>(across[b]));
        }
        moments[a] = in_powers(line);
      }
      add_cell(column, row, moments, color);
      for (int b = 0; b <= N; ++b) across[b] += cell.across(b);
      add_equal_cells(column + 1, i + 1 < columns_.size() ? columns_[i + 1] : end_column);
    }
  }
}

template class PaintedRows<1>;
template class PaintedRows<2>;
template class PaintedRows<3>;
template class PaintedRows<4>;
template class PaintedRows<8>;

}  // namespace prefilter
