// SPDX-License-Identifier: GPL-3.0-or-later

// Weights of cells under the filter of section 2.2, per pixel.
#include "prefilter/shapes/raster/cell_pixels.h"

#include <algorithm>

#include "prefilter/geometry/moments/arc_moments.h"

namespace prefilter {

CellPixels::CellPixels(const CellFilter& filter, int width)
    : filter_(filter), width_(width), is_box_(filter.taps == 1 && filter.degree == 0) {
  const int count = filter.degree + 1;
  const auto along = [&](int tap, int power) {
    double sum = 0.0;
    for (int a = 0; a < count; ++a) {
      sum += filter.along[tap * count + a] * mean_power(a + power);
    }
    return sum;
  };
  for (int oy = 0; oy < filter.taps; ++oy) {
    for (int ox = 0; ox < filter.taps; ++ox) {
      LinearPowers full{};
      for (std::size_t k = 0; k < full.size(); ++k) {
        const auto [m, n] = kLinearExponents[k];
        if (filter.is_separable) {
          full[k] = along(ox, m) * along(oy, n);
          continue;
        }
        const double* piece = filter.table.data() + (oy * filter.taps + ox) * count * count;
        for (int b = 0; b < count; ++b) {
          for (int a = 0; a < count; ++a) {
            full[k] += piece[b * count + a] * mean_power(a + m) * mean_power(b + n);
          }
        }
      }
      full_.push_back(full);
    }
  }
}

void CellPixels::begin(int first_row, int end_row, BandValues* values) {
  first_row_ = first_row;
  end_row_ = end_row;
  values_ = values;
}

// Calls use(values of the pixel, ox, oy) for the pixels whose filter covers a cell.
template <typename Use>
void CellPixels::for_pixels_over(int column, int row, const Use& use) const {
  const int begin_x = std::max(0, filter_.first_pixel_over(column));
  const int end_x = std::min(width_, filter_.last_pixel_over(column) + 1);
  const int begin_y = std::max(first_row_, filter_.first_pixel_over(row));
  const int end_y = std::min(end_row_, filter_.last_pixel_over(row) + 1);
  if (begin_x >= end_x) return;
  const int channels = values_->channels();
  for (int y = begin_y; y < end_y; ++y) {
    double* values = values_->pixels(y - first_row_, begin_x, end_x);
    for (int x = begin_x; x < end_x; ++x) {
      use(values + (x - begin_x) * channels, column - filter_.first_cell(x),
          row - filter_.first_cell(y));
    }
  }
}

void CellPixels::add(int column, int row, int channel, std::span<const double> moments) {
  const int count = filter_.degree + 1;
  for_pixels_over(column, row, [&](double* values, int ox, int oy) {
    double sum = 0.0;
    if (filter_.is_separable) {
      const double* along_x = filter_.along.data() + ox * count;
      const double* along_y = filter_.along.data() + oy * count;
      for (int a = 0; a < count; ++a) {
        double line = 0.0;
        for (int b = 0; b < count; ++b) line += along_y[b] * moments[a * count + b];
        sum += along_x[a] * line;
      }
    } else {
      const double* piece = filter_.table.data() + (oy * filter_.taps + ox) * count * count;
      for (int b = 0; b < count; ++b) {
        for (int a = 0; a < count; ++a) sum += piece[b * count + a] * moments[a * count + b];
      }
    }
    values[channel] += sum;
  });
}

void CellPixels::add_full(int column, int row, double share, std::span<const LinearPowers> color) {
  for_pixels_over(column, row, [&](double* values, int ox, int oy) {
    const LinearPowers& full = full_[oy * filter_.taps + ox];
    for (std::size_t c = 0; c < color.size(); ++c) {
      double sum = 0.0;
      for (std::size_t k = 0; k < full.size(); ++k) sum += full[k] * color[c][k];
      values[c] += share * sum;
    }
  });
}

void CellPixels::add_constant(int begin, int end, int row, std::span<const double> color) {
  if (is_box_) {
    add_row(begin, end, row, [&](int first, int last, double* out) {
      for (int column = first; column < last; ++column) {
        for (const double value : color) *out++ += value;
      }
    });
    return;
  }
  for (int column = begin; column < end; ++column) {
    for_pixels_over(column, row, [&](double* values, int ox, int oy) {
      const double share = full_[oy * filter_.taps + ox][0];
      for (std::size_t c = 0; c < color.size(); ++c) values[c] += share * color[c];
    });
  }
}

}  // namespace prefilter
