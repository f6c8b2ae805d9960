#include "prefilter/raster/moment_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace prefilter {
namespace {

constexpr double kMomentUnit = 1.0 / (1 << kMomentBits);
// Of a run's weights: times moments they make coverage.
constexpr int kWeightBits = kCoverageBits - kMomentBits;

}  // namespace

template <int N>
MomentRows<N>::MomentRows(const CellFilter& filter, int width) : filter_(filter), width_(width) {
  const int count = filter.degree + 1;
  const int taps = filter.taps;
  // Powers of y by P_b: y^b is P_b + its mean P_0.
  const auto by_basis = [&](const auto& coefficient) {
    Doubles out{};
    for (int b = 0; b < count; ++b) {
      out[b] += coefficient(b);
      if (b > 0) out[0] += coefficient(b) * mean_power(b);
    }
    return out;
  };
  std::vector<Doubles> run_weights;
  if (filter.is_separable) {
    integrals_before_.push_back(0.0);
    for (int tap = 0; tap < taps; ++tap) {
      const double* along = filter.along.data() + tap * count;
      along_y_.push_back(by_basis([&](int b) { return along[b]; }));
      double integral = 0.0;
      for (int a = 0; a < count; ++a) integral += along[a] * mean_power(a);
      integrals_before_.push_back(integrals_before_.back() + integral);
    }
    integrals_before_.back() = 1.0;
    run_weights = along_y_;
  } else {
    for (int oy = 0; oy < taps; ++oy) {
      Doubles before{};
      table_before_.push_back(before);
      for (int ox = 0; ox < taps; ++ox) {
        const double* piece = filter.table.data() + (oy * taps + ox) * count * count;
        for (int a = 0; a < count; ++a) {
          table_.push_back(by_basis([&](int b) { return piece[b * count + a]; }));
          before += table_.back() * mean_power(a);
        }
        table_before_.push_back(before);
      }
      run_weights.push_back(before);
    }
  }
  constexpr double kScale = std::int64_t{1} << kWeightBits;
  std::int64_t sum = 0;
  for (const Doubles& weights : run_weights) {
    Longs rounded{};
    for (int b = 0; b <= N; ++b) rounded[b] = std::llrint(weights[b] * kScale);
    sum += rounded[0];
    run_weights_.push_back(rounded);
  }
  // Full rows then weigh 1 together, to the last bit.
  run_weights_[taps / 2][0] += (std::int64_t{1} << kWeightBits) - sum;
}

template <int N>
std::int64_t MomentRows<N>::run_value(int tap, const Longs& across) const {
  return (run_weights_[tap] * across).sum();
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
  for (int row = cells.window().first_row; row < cells.window().end_row; ++row) {
    cells.columns_of(row, &columns_);
    Longs across{};
    const auto left = cells.left_of(row);
    for (int b = 0; b <= N; ++b) across[b] = left[b];
    start_row(row, across, rows);
    // What lies between two cells whose pixels do not meet is a run.
    for (std::size_t begin = 0; begin < columns_.size();) {
      std::size_t end = begin + 1;
      while (end < columns_.size() && columns_[end] < columns_[end - 1] + filter_.taps) ++end;
      add_span(cells, row, std::span(columns_).subspan(begin, end - begin), &across, rows);
      begin = end;
    }
  }
}

// What is left of all columns is a run from the first pixel on.
template <int N>
void MomentRows<N>::start_row(int row, const Longs& across, CoverageRows* rows) {
  const int begin_y = std::max(first_row_, filter_.first_pixel_over(row));
  const int end_y = std::min(end_row_, filter_.last_pixel_over(row) + 1);
  for (int y = begin_y; y < end_y; ++y) {
    const std::int64_t value = run_value(row - filter_.first_cell(y), across);
    if (value != 0) rows->add_step(y - first_row_, 0, value);
  }
}

template <int N>
void MomentRows<N>::add_span(const MomentCells<N>& cells, int row, std::span<const int> columns,
                             Longs* across, CoverageRows* rows) {
  const int taps = filter_.taps;
  const int count = filter_.degree + 1;
  const int first_column = columns.front();
  const int last_column = columns.back();
  // The pixels that weigh some cell of the span.
  const int first_pixel = std::max(0, filter_.first_pixel_over(first_column));
  const int end_pixel = std::min(width_, filter_.last_pixel_over(last_column) + 1);
  const int pixels = std::max(0, end_pixel - first_pixel);
  const Longs across_before = *across;

  const auto in_units = [](const Longs& integers) {
    return integers.template as<double>() * kMomentUnit;
  };
  if (filter_.is_separable) {
    sums_.assign(pixels, Doubles{});
  } else {
    values_.assign(static_cast<std::size_t>(pixels) * taps, 0.0);
  }
  // Cells [from, to) that are alike.
  const auto add_alike = [&](int from, int to, const Longs& integers) {
    const Doubles moments = in_units(integers);
    const int begin = std::max(first_pixel, filter_.first_pixel_over(from));
    const int end = std::min(end_pixel, filter_.last_pixel_over(to - 1) + 1);
    for (int pixel = begin; pixel < end; ++pixel) {
      const int low = taps_before(pixel, from);
      const int high = taps_before(pixel, to);
      if (filter_.is_separable) {
        sums_[pixel - first_pixel] += moments * (integrals_before_[high] - integrals_before_[low]);
        continue;
      }
      for (int oy = 0; oy < taps; ++oy) {
        const Doubles* before = table_before_.data() + oy * (taps + 1);
        values_[(pixel - first_pixel) * taps + oy] +=
            (moments * (before[high] - before[low])).sum();
      }
    }
  };
  const auto add_cell = [&](int column, const std::array<Doubles, N + 1>& moments) {
    const int begin = std::max(first_pixel, filter_.first_pixel_over(column));
    const int end = std::min(end_pixel, filter_.last_pixel_over(column) + 1);
    for (int pixel = begin; pixel < end; ++pixel) {
      const int ox = column - filter_.first_cell(pixel);
      if (filter_.is_separable) {
        const double* along = filter_.along.data() + ox * count;
        Doubles sum{};
        for (int a = 0; a < count; ++a) sum += moments[a] * along[a];
        sums_[pixel - first_pixel] += sum;
        continue;
      }
      for (int oy = 0; oy < taps; ++oy) {
        const Doubles* powers = table_.data() + (oy * taps + ox) * count;
        Doubles products{};
        for (int a = 0; a < count; ++a) products += powers[a] * moments[a];
        values_[(pixel - first_pixel) * taps + oy] += products.sum();
      }
    }
  };

  constexpr int kFar = 1 << 28;
  add_alike(-kFar, first_column, *across);
  int next = first_column;
  for (const int column : columns) {
    if (column > next) add_alike(next, column, *across);
    const ArcMoments<N>& cell = cells.at(column, row);
    Longs cell_across{};
    for (int b = 0; b <= N; ++b) cell_across[b] = cell.across(b);
    const Doubles own = in_units(cell_across);
    const Doubles before = in_units(*across);
    std::array<Doubles, N + 1> moments;
    for (int a = 0; a < count; ++a) {
      Longs inside{};
      for (int b = 0; b <= N; ++b) inside[b] = cell.inside(a, b);
      moments[a] = own * at_high_end(a) - in_units(inside) + before * mean_power(a);
    }
    add_cell(column, moments);
    *across += cell_across;
    next = column + 1;
  }
  add_alike(next, kFar, *across);

  // The rows of pixels that weigh this row of cells.
  constexpr double kScale = std::int64_t{1} << kCoverageBits;
  const int begin_y = std::max(first_row_, filter_.first_pixel_over(row));
  const int end_y = std::min(end_row_, filter_.last_pixel_over(row) + 1);
  for (int y = begin_y; y < end_y; ++y) {
    const int tap = row - filter_.first_cell(y);
    std::int64_t last = run_value(tap, across_before);
    for (int i = 0; i < pixels; ++i) {
      const double value =
          filter_.is_separable ? (along_y_[tap] * sums_[i]).sum() : values_[i * taps + tap];
      const std::int64_t here = std::llrint(value * kScale);
      rows->add_step(y - first_row_, first_pixel + i, here - last);
      last = here;
    }
    rows->add_step(y - first_row_, first_pixel + pixels, run_value(tap, *across) - last);
  }
}

template class MomentRows<0>;
template class MomentRows<1>;
template class MomentRows<2>;
template class MomentRows<3>;
template class MomentRows<7>;

}  // namespace prefilter
